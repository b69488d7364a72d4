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

/// The same trajectory with the first pose at the origin.
Trajectory relative_to_first(const Trajectory& trajectory);

/// Length of the path in metres.
double path_length_m(const Trajectory& trajectory);

/// TUM: "stamp x y z qx qy qz qw" per line, '#' comments, stamps rise. KITTI: 12 numbers per line,
/// the upper three rows of T_map_sensor; KITTI has no stamps, so stamps are index * period_s.
/// Rotations are made orthonormal. All throw Error with file and line; a file without a pose is
/// one.
Trajectory read_tum(const std::string& path);
Trajectory read_kitti_poses(const std::string& path, double period_s = 0.1);
void write_tum(const Trajectory& trajectory, const std::string& path);
void write_kitti_poses(const Trajectory& trajectory, const std::string& path);
/// A pose as these files have it, a line of its own.
std::string tum_line(const StampedPose& pose);
std::string kitti_line(const StampedPose& pose);
/// Tells the two apart by the number of columns (8 or 12).
Trajectory read_trajectory(const std::string& path, double period_s = 0.1);

enum class TrajectoryForm { kTum, kKitti };
/// A trajectory with the form that its file was found to have: TUM's stamps were recorded, KITTI's
/// are counted.
struct ParsedTrajectory {
  Trajectory poses;
  TrajectoryForm form = TrajectoryForm::kTum;
};
/// read_trajectory, and which of the two it was.
ParsedTrajectory parse_trajectory(const std::string& path, double period_s = 0.1);

}  // namespace hqslam
