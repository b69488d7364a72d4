#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "hqslam/pipeline/scan_poses.h"

namespace hqslam::tools {

using pipeline::kMaxStampDifference_s;

/// The poses of `file` with stamps that can be compared with those of `other`: where `file` has
/// none, pose i gets the stamp of pose i of `other`. Throws Error where those are not as many.
Trajectory with_stamps_of(const TrajectoryFile& file, const Trajectory& other);

/// with_stamps_of where `file` has a pose for every scan of a recording and `other` only for some:
/// scan_of_pose has the scan of each of its poses, counted from 0 in the recording.
Trajectory with_stamps_of_scans(const TrajectoryFile& file, const Trajectory& other,
                                const std::vector<std::int64_t>& scan_of_pose);

/// An estimate held against a reference.
struct ReferenceComparison {
  std::string reference_path;
  AbsolutePoseError error;  ///< SE(3)-aligned
  Trajectory reference;     ///< the poses that were compared, in the reference's own frame
  std::string units;        ///< complaint_about_units()
};
/// Nothing if fewer than 3 poses can be paired.
std::optional<ReferenceComparison> compare_with_reference(const Trajectory& estimate,
                                                          const TrajectoryFile& reference);

/// "the reference's path is 1000 times as long as the estimate's; millimetres?", over the poses
/// that are paired; empty where no unit explains a difference.
std::string complaint_about_units(const Trajectory& estimate, const Trajectory& reference,
                                  const PosePairs& pairs);

}  // namespace hqslam::tools
