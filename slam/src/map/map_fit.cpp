#include "map_fit.h"

#include <fmt/format.h>

#include <algorithm>

namespace hqslam::slam {

namespace {

/// Of the given map's own ratio. Of simulated drives: 0.79 and more in the same rooms, 0.31 to 0.62
/// in others of the same style; outdoors about 1 and more, and no other place is recognized. Four
/// real recordings, each in a map of its own, are not doubted.
constexpr double kLeastShare = 0.65;
constexpr int kFewestScans = 20;

}  // namespace

void MapFit::add(double close_ratio) {
  sum_ += close_ratio;
  ++scans_;
  recent_ += (close_ratio - recent_) / std::min(scans_, kFewestScans);
}

double MapFit::mean_close_ratio() const { return scans_ == 0 ? 0.0 : sum_ / scans_; }

bool MapFit::is_doubtful() const { return scans_ > 0 && recent_ < kLeastShare * given_; }

std::string MapFit::complaint() const {
  const double expected = given_ * scans_;
  if (scans_ < kFewestScans || sum_ >= kLeastShare * expected) return "";
  return fmt::format(
      "scans fit it {:.2f} times as well as those of its own drive did: it is of another place, or "
      "much has changed",
      sum_ / expected);
}

}  // namespace hqslam::slam
