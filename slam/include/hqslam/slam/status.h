#pragma once

#include <string_view>

namespace hqslam::slam {

/// How a stage of SLAM ended for one scan.
enum class Status {
  kOk,
  /// Too few matches. Mapping: the odometry's motion is used. Odometry: the prediction is used for
  /// what no search found; ground may have given height, roll and pitch, or edges x, y and yaw.
  kTooFewFeatures,
  kDegenerate,    ///< a direction of motion was not observable: there the prediction is used
  kNotConverged,  ///< the iteration limit was reached while the estimate still moved
  /// Mapping: registered, but after a gap of more than ten periods: the search began at a guess and
  /// may have found a similar place.
  kAfterGap,
  /// Mapping in a saved map: registered, but the last twenty scans or so fitted the map far less
  /// than those of its own drive did: it may be of another place that looks alike, or have changed.
  kMapInDoubt,
  /// Mapping in a saved map: no place in the map was recognized, the pose is unknown.
  kNotRecognized,
};

constexpr std::string_view name(Status status) {
  constexpr std::string_view kNames[] = {
      "ok",          "too few features", "degenerate",    "not converged",
      "after a gap", "map in doubt",     "not recognized"};
  return kNames[static_cast<int>(status)];
}

/// Whether the pose of a scan with this mapping status was measured against the map.
constexpr bool is_registered(Status status) {
  return status != Status::kTooFewFeatures && status != Status::kNotRecognized;
}

}  // namespace hqslam::slam
