#include "map/map_fit.h"

#include <algorithm>

namespace hqslam::slam {

namespace {

/// Of the given map's own ratio. Simulated drives have 0.79 and more in the same rooms, in others
/// of the same style 0.20 to 0.62 but for two of 39 pairs (0.73 and 0.77), outdoors about 1 and
/// more. Five real recordings, each in a map of its own, are not doubted.
constexpr double kLeastShare = 0.65;
constexpr int kScans = 20;

}  // namespace

void MapFit::add(double close_ratio) {
  sum_ += close_ratio;
  ++scans_;
  recent_ += (close_ratio - recent_) / std::min(scans_, kScans);
}

double MapFit::mean_close_ratio() const { return scans_ == 0 ? 0.0 : sum_ / scans_; }

bool MapFit::is_doubtful() const { return scans_ > 0 && recent_ < kLeastShare * given_; }

}  // namespace hqslam::slam
