#pragma once

#include <cstddef>
#include <string_view>

namespace hqslam::slam {

/// The result of loop closing for a scan.
enum class LoopStatus {
  kNotSearched,   ///< switched off, or too little path since the last search
  kNoCandidate,   ///< no older place within reach of plausible drift is similar
  kNotVerified,   ///< some are, but the scan does not fit there
  kAmbiguous,     ///< the scan fits at several places: none is taken
  kAwaitsOthers,  ///< a loop was found; it counts when later ones agree with it
  kAgrees,        ///< the place was recognized at the estimated pose, within 0.15 m
  kClosed,        ///< the path and the map were corrected
  kImplausible,   ///< no correction was found, or one that bends the path too much: the loops are
                  ///< dropped
};
constexpr std::string_view name(LoopStatus status) {
  constexpr std::string_view kNames[] = {"not searched", "no candidate",  "not verified",
                                         "ambiguous",    "awaits others", "agrees",
                                         "closed",       "implausible"};
  return kNames[static_cast<int>(status)];
}

struct LoopReport {
  LoopStatus status = LoopStatus::kNotSearched;
  int candidates = 0;          ///< places compared
  std::size_t scan = 0;        ///< the scan that was searched: some scans before that of the report
  std::size_t older_scan = 0;  ///< kAwaitsOthers, kAgrees, kClosed: the scan at the same place
  double correction_m = 0.0;   ///< translation of its pose, by loops or by levelling
};

}  // namespace hqslam::slam
