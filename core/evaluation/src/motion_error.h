#pragma once

#include <cstddef>

#include "hqslam/core/pose.h"
#include "hqslam/evaluation/trajectory_error.h"

namespace hqslam {

/// The motion between two poses of one frame.
struct Motion {
  Pose T_frame_from;
  Pose T_frame_to;
};

/// E = (T_ref_from^-1 T_ref_to)^-1 (T_est_from^-1 T_est_to): what the estimate adds to the true
/// motion. The frames of the two need not agree.
inline Pose motion_error(const Motion& estimate, const Motion& reference) {
  const Pose true_motion = reference.T_frame_from.inverse() * reference.T_frame_to;
  return true_motion.inverse() * (estimate.T_frame_from.inverse() * estimate.T_frame_to);
}

/// Throws Error if there are fewer than `expected`.
void require_pairs(const PosePairs& pairs, std::size_t expected, double max_difference_s);

}  // namespace hqslam
