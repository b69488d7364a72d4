#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "hqslam/evaluation/drift.h"
#include "hqslam/evaluation/trajectory_error.h"

namespace hqslam::tools {

/// Errors of a trajectory against a reference.
struct TrajectoryErrors {
  double ape_rmse_m = 0.0;   ///< of the position, SE(3)-aligned
  double path_m = 0.0;       ///< of the reference, over the poses that were compared
  RelativePoseError pieces;  ///< over pieces of kDriftPiece_m; none if the path is shorter
  std::vector<Slip> slips;
};
/// Nothing if fewer than 3 poses can be paired.
std::optional<TrajectoryErrors> trajectory_errors(const Trajectory& estimate,
                                                  const Trajectory& reference);

/// Errors of every method on one drive, against one reference.
struct DriveErrors {
  std::string kind;                        ///< town, hills, ...; of a recording its name
  std::optional<std::uint64_t> seed = {};  ///< of a simulated drive
  std::int64_t scans = 0;                  ///< of the recording
  std::int64_t scans_left_out = 0;         ///< of these
  std::vector<TrajectoryErrors> methods = {};

  double path_m() const { return methods.back().path_m; }
};

}  // namespace hqslam::tools
