#pragma once

#include <string_view>

namespace hqslam::slam {

/// How a stage of SLAM ended for one scan.
enum class Status {
  kOk,
  /// Too little matched. Mapping: the prediction stands. Odometry: the prediction stands for what
  /// no search told; ground may have told height, roll and pitch, or edges x, y and yaw.
  kTooFewFeatures,
  kDegenerate,    ///< some direction of motion was not observable: there the prediction stands
  kNotConverged,  ///< the iteration limit was reached while the estimate still moved
};

std::string_view name(Status status);  ///< "ok", "too few features", "degenerate", "not converged"

}  // namespace hqslam::slam
