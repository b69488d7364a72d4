#pragma once

#include <optional>
#include <string>

#include "hqslam/core/trajectory.h"
#include "hqslam/core/trajectory_error.h"

namespace hqslam::tools {

/// The poses of `file` with stamps that can be compared with those of `other`: where `file` has
/// none, pose i gets the stamp of pose i of `other`. Poses beyond the length of `other` are left
/// out.
Trajectory with_stamps_of(const TrajectoryFile& file, const Trajectory& other);

/// An estimate held against a reference.
struct ReferenceComparison {
  std::string reference_path;
  AbsolutePoseError error;  ///< SE(3)-aligned
  Trajectory reference;     ///< the poses that were compared, in the reference's own frame
};
/// Nothing if fewer than 3 poses can be paired.
std::optional<ReferenceComparison> compare_with_reference(const Trajectory& estimate,
                                                          const TrajectoryFile& reference);

}  // namespace hqslam::tools
