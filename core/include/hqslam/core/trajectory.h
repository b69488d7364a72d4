#pragma once

#include <string>
#include <vector>

#include "hqslam/core/pose.h"

namespace hqslam {

struct StampedPose {
  double stamp_s = 0.0;
  Pose T_map_sensor = Pose::Identity();
};

/// Poses in the order of time.
using Trajectory = std::vector<StampedPose>;

/// Length of the path in metres.
double path_length_m(const Trajectory& trajectory);

/// TUM: "stamp x y z qx qy qz qw" per line, '#' comments, stamps rise. KITTI: 12 numbers per line,
/// the upper three rows of T_map_sensor; KITTI has no stamps, so stamps are index * period_s.
/// Rotations are made orthonormal. All throw Error with file and line, also for a file without a
/// pose.
Trajectory read_tum(const std::string& path);
Trajectory read_kitti_poses(const std::string& path, double period_s = 0.1);
void write_tum(const Trajectory& trajectory, const std::string& path);
void write_kitti_poses(const Trajectory& trajectory, const std::string& path);
/// A pose as one line of such a file.
std::string tum_line(const StampedPose& pose);
std::string kitti_line(const StampedPose& pose);
/// A trajectory from a TUM or KITTI file, which differ in the number of columns, 8 or 12.
struct TrajectoryFile {
  std::string path;
  Trajectory poses;
  bool has_stamps = false;  ///< true for TUM; KITTI's stamps are counted
};
TrajectoryFile read_trajectory_file(const std::string& path, double period_s = 0.1);

}  // namespace hqslam
