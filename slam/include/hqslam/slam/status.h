#pragma once

#include <cstddef>
#include <string_view>

namespace hqslam::slam {

/// How a stage of SLAM ended for one scan.
enum class Status {
  kOk,
  /// Too little matched. Mapping: the prediction stands. Odometry: the prediction stands for what
  /// no search found; ground may have given height, roll and pitch, or edges x, y and yaw.
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

/// What loop closing found out about a scan.
enum class LoopStatus {
  kNotSearched,   ///< switched off, or too little path since the last search
  kNoCandidate,   ///< no older place within reach of plausible drift looks like this one
  kNotVerified,   ///< some do, but the scan does not fit there
  kAmbiguous,     ///< the scan fits at several places: none is taken
  kAwaitsOthers,  ///< a loop was found; it counts when others farther on agree with it
  kAgrees,        ///< the place was recognised where it was believed to be, within 0.15 m
  kClosed,        ///< the path and the map were corrected
  kImplausible,   ///< no correction was found, or it would have bent the path too much: nothing was
                  ///< done, and the loops are forgotten
};
std::string_view name(LoopStatus status);  ///< "not searched", "no candidate", ...

struct LoopReport {
  LoopStatus status = LoopStatus::kNotSearched;
  int candidates = 0;          ///< places that were looked at
  std::size_t scan = 0;        ///< the one that was looked for: some scans before the report's own
  std::size_t older_scan = 0;  ///< kAwaitsOthers, kAgrees, kClosed: the scan that it met
  double correction_m = 0.0;   ///< by how much its pose moved, also where the path was put upright
};

}  // namespace hqslam::slam
