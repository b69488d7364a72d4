// What statuses and kinds are called in files, on pages and in messages.

#include <array>

#include "hqslam/slam/scan_trace.h"
#include "hqslam/slam/status.h"

namespace hqslam::slam {

std::string_view name(Status status) {
  constexpr std::array<std::string_view, 6> kNames = {
      "ok", "too few features", "degenerate", "not converged", "after a gap", "not recognized"};
  return kNames[static_cast<std::size_t>(status)];
}

bool is_registered(Status status) {
  return status != Status::kTooFewFeatures && status != Status::kNotRecognized;
}

std::string_view name(LoopStatus status) {
  constexpr std::array<std::string_view, 8> kNames = {
      "not searched",  "no candidate", "not verified", "ambiguous",
      "awaits others", "agrees",       "closed",       "implausible"};
  return kNames[static_cast<std::size_t>(status)];
}

std::string_view name(FeatureKind kind) {
  constexpr std::array<std::string_view, 4> kNames = {"edge", "post", "ground", "surface"};
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace hqslam::slam
