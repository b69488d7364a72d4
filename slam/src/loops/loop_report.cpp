#include "hqslam/slam/loop_report.h"

namespace hqslam::slam {

std::string_view name(LoopStatus status) {
  switch (status) {
    case LoopStatus::kNotSearched:
      return "not searched";
    case LoopStatus::kNoCandidate:
      return "no candidate";
    case LoopStatus::kNotVerified:
      return "not verified";
    case LoopStatus::kAmbiguous:
      return "ambiguous";
    case LoopStatus::kAwaitsOthers:
      return "awaits others";
    case LoopStatus::kAgrees:
      return "agrees";
    case LoopStatus::kClosed:
      return "closed";
    case LoopStatus::kImplausible:
      break;
  }
  return "implausible";
}

}  // namespace hqslam::slam
