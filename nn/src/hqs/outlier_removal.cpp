#include "hqslam/nn/hqs/outlier_removal.h"

#include <fmt/format.h>

#include <numbers>

#include "hqslam/core/error.h"

namespace hqslam::nn {

OutlierRemoval::OutlierRemoval(const SensorModel& sensor, RowSelection measured_rows,
                               const OutlierRemovalOptions& options, int columns)
    : rows_(sensor.rows()), columns_(columns) {
  if (!(options.min_angle_rad > 0.0 && options.min_angle_rad < std::numbers::pi / 2.0)) {
    throw Error(fmt::format("outlier removal: min_angle_rad is {}, expected 0 < angle < pi/2",
                            options.min_angle_rad));
  }
  if (options.min_pixels < 0) {
    throw Error(
        fmt::format("outlier removal: min_pixels is {}, expected 0 or more", options.min_pixels));
  }
  if (columns < 1 || columns > sensor.columns) {
    throw Error(fmt::format("outlier removal: columns is {}, expected 1 to {}, the sensor's",
                            columns, sensor.columns));
  }
  if (measured_rows.offset < 0 || measured_rows.stride < 1) {
    throw Error(
        fmt::format("outlier removal: measured rows are {}, {} + {}, ..., expected an "
                    "offset of 0 or more and a stride of 1 or more",
                    measured_rows.offset, measured_rows.offset, measured_rows.stride));
  }
}

}  // namespace hqslam::nn
