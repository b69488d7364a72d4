#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/training/augmentation.h"

namespace hqslam::nn {

/// A sensor whose beams are some rows of another one with many.
struct DrawnBeams {
  SensorModel sensor;  ///< with all rows
  RowSelection measured_rows;
  std::vector<int> rows;  ///< of the other sensor, from top to bottom
  int column_step = 1;    ///< of its columns, every such one
};

/// A sensor with 8 to 64 measured rows and twice or four times as many in all: evenly spaced, with
/// gaps that change smoothly, or with the table of a preset; some see less far than others. Every
/// other one has half of the columns. In every group of rows the last one is measured or, with
/// any_offset, in two of five sensors another one.
DrawnBeams draw_beams(const SensorModel& all, std::uint64_t seed, bool any_offset = true);
/// The beams of `all` that are nearest to those of a sensor, in its columns. Throws Error unless
/// `all` has a multiple of them.
DrawnBeams beams_like(const SensorModel& all, const SensorModel& sensor,
                      RowSelection measured_rows);

/// What the drawn sensor would have seen of a scan of all rows.
TrainingScan seen_by(const DrawnBeams& beams, const TrainingScan& scan);

}  // namespace hqslam::nn
