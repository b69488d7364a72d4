// What statuses and kinds are called in files, on pages and in messages.

#include <array>

#include "hqslam/slam/loop_report.h"
#include "hqslam/slam/scan_trace.h"
#include "hqslam/slam/status.h"

namespace hqslam::slam {

namespace {

template <typename Value, std::size_t kCount>
std::string_view name_of(Value value, const std::array<std::string_view, kCount>& names) {
  const auto index = static_cast<std::size_t>(value);
  return index < kCount ? names[index] : "unknown";
}

}  // namespace

std::string_view name(Status status) {
  return name_of(status,
                 std::array<std::string_view, 6>{"ok", "too few features", "degenerate",
                                                 "not converged", "after a gap", "not recognized"});
}

bool is_registered(Status status) {
  return status != Status::kTooFewFeatures && status != Status::kNotRecognized;
}

std::string_view name(LoopStatus status) {
  return name_of(status, std::array<std::string_view, 8>{
                             "not searched", "no candidate", "not verified", "ambiguous",
                             "awaits others", "agrees", "closed", "implausible"});
}

std::string_view name(FeatureKind kind) {
  return name_of(kind, std::array<std::string_view, 4>{"edge", "post", "ground", "surface"});
}

}  // namespace hqslam::slam
