#pragma once

#include <string_view>

namespace hqslam::slam {

/// How a stage of SLAM ended for one scan.
enum class Status {
  kOk,
  /// Too little matched. Mapping: the odometry's motion stands. Odometry: the prediction stands for
  /// what no search found; ground may have given height, roll and pitch, or edges x, y and yaw.
  kTooFewFeatures,
  kDegenerate,    ///< some direction of motion was not observable: there the prediction stands
  kNotConverged,  ///< the iteration limit was reached while the estimate still moved
  /// Mapping: registered, but scans are missing before this one (more than ten periods): where it
  /// was looked for was a guess, and a place that looks alike would not be noticed.
  kAfterGap,
  /// Mapping in a saved map: the place is not known, or not any more; nothing is known of the pose.
  kNotRecognized,
};

std::string_view name(Status status);  ///< "ok", "too few features", "degenerate", "not converged",
                                       ///< "after a gap", "not recognized"

/// Of a mapping status: whether the pose was measured against the map.
bool is_registered(Status status);

}  // namespace hqslam::slam
