#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace hqslam {

/// One revolution of a sensor as points in the sensor frame, in the order of the file.
struct Scan {
  /// The time that the pose of the scan belongs to.
  double stamp_s = 0.0;
  std::vector<Eigen::Vector3f> points_m;
  /// Row of each point, 0 the highest beam; empty if the sensor does not tell.
  std::vector<std::uint16_t> row;
  /// Capture time of each point minus stamp_s; empty if all points are given for stamp_s (a
  /// motion-corrected scan).
  std::vector<float> time_offset_s;
  /// How bright each return was, in the sensor's own unit: reflectivity where it says that (Hesai,
  /// Ouster: 0 to 255, of old firmware to 65,535), else what it calls intensity (Velodyne 0 to 255,
  /// KITTI 0 to 1). Empty if it does not say.
  std::vector<float> intensity;
  /// Of each point, as OrganizedCloud::confidence; empty if nothing is known of it.
  std::vector<float> confidence;
  /// Points of the file that were not finite or lay at the origin: left out and counted here.
  std::int64_t invalid_points = 0;
};

}  // namespace hqslam
