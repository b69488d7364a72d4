#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "arrays.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/range_image.h"
#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::python {

using ImageInput = Input<float, -1, -1>;
RangeImage image_of(const ImageInput& range_m);
inline Image view(std::vector<float>& values, int rows, int columns) {
  return Image(values.data(), {static_cast<std::size_t>(rows), static_cast<std::size_t>(columns)});
}

using PointsInput = Input<float, -1, 3>;
using RowsInput = std::optional<Input<std::uint16_t, -1>>;
using TimesInput = std::optional<Input<float, -1>>;
/// Points of a driver.
Scan scan_of(const PointsInput& points_m, const RowsInput& row, const TimesInput& time_offset_s);
/// scan_of in the pixels of a sensor. Throws Error.
OrganizedCloud cloud_of(const PointsInput& points_m, const SensorModel& sensor,
                        const RowsInput& row, const TimesInput& time_offset_s);

inline PointList owned_points(std::vector<Eigen::Vector3f> points_m) {
  const std::size_t points = points_m.size();
  return owned<PointList>(std::move(points_m), {points, 3});
}

}  // namespace hqslam::python
