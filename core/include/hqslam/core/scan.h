#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace hqslam {

/// One revolution of a sensor as points in the sensor frame, in the order of the file.
struct Scan {
  /// The time to which the pose of the scan refers.
  double stamp_s = 0.0;
  std::vector<Eigen::Vector3f> points_m;
  /// Row of each point, 0 the highest beam; empty if unknown.
  std::vector<std::uint16_t> row;
  /// Capture time of each point minus stamp_s; empty if all points are given for stamp_s (a
  /// motion-corrected scan).
  std::vector<float> time_offset_s;
  /// Brightness of each return in the sensor's own unit: reflectivity where it is recorded (Hesai,
  /// Ouster: 0 to 255, with old firmware to 65,535), else intensity (Velodyne 0 to 255, KITTI 0 to
  /// 1). Empty if neither is recorded.
  std::vector<float> intensity;
  /// Confidence of each point as in OrganizedCloud; empty if unknown.
  std::vector<float> confidence;
  /// Points of the file that were left out because they were not finite or at the origin.
  std::int64_t invalid_points = 0;
};

}  // namespace hqslam
