#pragma once

#include <string>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// A scan or a map: .pcd (ascii, binary or binary_compressed; version 0.7), .ply (ascii or
/// binary_little_endian), KITTI's .bin, any other as text, fields of any type and order, x y z
/// among them. Points that are not finite or at the origin are dropped and counted. Time offsets
/// come from a field of times (t, time, timestamp, offset_time or the like), in the unit in which
/// they last a turn, without a sensor a second at most. They count from the middle of the file's
/// times; stamp_s is that middle where the times are those of a clock, otherwise 0. Rows are left
/// empty. Throws Error, also for more than 33 million points.
Scan read_cloud(const std::string& path);

/// read_cloud with rows from a field of rings (ring, channel, line or the like), if there is one.
/// Throws Error, also for a ring that the sensor does not have.
Scan read_cloud(const std::string& path, const SensorModel& sensor);

/// Writes the points of a scan with what is known of each, binary, as .pcd or .ply by the ending of
/// the name, with fields x y z, intensity, ring (0 the highest beam), timestamp (seconds) and
/// confidence. Throws Error for another ending, and if there are not as many of something as
/// points.
void write_cloud(const Scan& scan, const std::string& path);

}  // namespace hqslam
