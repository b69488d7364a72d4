#pragma once

#include <string>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// A .pcd file (ascii, binary or binary_compressed; fields of any type and order, x y z among
/// them). Points that are not finite or at the origin are dropped and counted. Time offsets come
/// from a field of times (t, time, timestamp, offset_time or the like), in the unit in which they
/// last a turn, without a sensor a second at most. They count from the middle of the file's times;
/// stamp_s is that middle where the times are those of a clock, otherwise 0. Rows are left empty.
/// Throws Error, also for more than 33 million points. Source of the format: Point Cloud Library,
/// "The PCD file format", version 0.7.
Scan read_pcd(const std::string& path);

/// The same with rows from a field of rings (ring, channel, line or the like), where there is one.
/// Throws Error, also for a ring that the sensor does not have.
Scan read_pcd(const std::string& path, const SensorModel& sensor);

/// Writes x y z (float32), binary. Throws Error. For more of each point: write_cloud.
void write_pcd(const std::vector<Eigen::Vector3f>& points_m, const std::string& path);

}  // namespace hqslam
