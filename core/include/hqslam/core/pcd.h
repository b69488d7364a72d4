#pragma once

#include <string>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// A .pcd file (ascii, binary or binary_compressed; fields of any type and order, x y z among
/// them). Points that are not finite or at the origin are dropped and counted. Time offsets come
/// from a field t, time or timestamp: seconds if it is a float, nanoseconds if it is an integer
/// (Ouster). They count from the middle of the file's times, and stamp_s stays 0: who knows when
/// the scan was taken sets it. Rows are left empty. Throws Error, also for more than 33 million
/// points. Source of the format: Point Cloud Library, "The PCD file format", version 0.7.
Scan read_pcd(const std::string& path);

/// The same with rows from a field `ring`, where there is one. Some drivers number rings from the
/// highest beam (Ouster), some from the lowest (Velodyne): the correlation of ring and elevation
/// tells, and rows count from the highest either way. Rings that follow the elevation in neither
/// way are left out, so that the elevation decides. Throws Error, also for a ring that the sensor
/// does not have.
Scan read_pcd(const std::string& path, const SensorModel& sensor);

/// Writes x y z (float32), binary, and where `confidence` is not empty a field of that name. Throws
/// Error, also if there are not as many confidences as points.
void write_pcd(const std::vector<Eigen::Vector3f>& points_m, const std::string& path,
               const std::vector<float>& confidence = {});

}  // namespace hqslam
