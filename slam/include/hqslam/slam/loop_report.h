#pragma once

#include <cstddef>
#include <string_view>

namespace hqslam::slam {

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
