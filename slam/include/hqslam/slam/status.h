#pragma once

#include <string_view>

namespace hqslam::slam {

/// How a stage of SLAM ended for one scan.
enum class Status {
  kOk,
  kTooFewFeatures,  ///< nothing was estimated: the prediction stands
  kDegenerate,      ///< some direction of motion was not observable: there the prediction stands
  kNotConverged,    ///< the iteration limit was reached while the estimate still moved
};

std::string_view name(Status status);  ///< "ok", "too few features", "degenerate", "not converged"

}  // namespace hqslam::slam
