#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "map/feature_map.h"

namespace hqslam::slam {

/// The line or plane (`Fit`) through the k = kNeighbours points of the map nearest to a feature,
/// with a new search and a new fit only when they may have changed.
///
/// While a scan is registered its features move by less and less. With d the distance of the last
/// of the k nearest points and e that of the next, a feature that moved by s < (e - d) / 2 has the
/// same k nearest points (d + s < e - s), and the same fit. One with d - s > reach has none,
/// whatever its neighbours are; with fewer than k points found, d is at least the distance up to
/// which all points are known. A feature that moved farther has its neighbours among the points
/// that the last search kept (NearbyPoints), or is searched anew. LOAM searches in every iteration.
template <typename Fit, int kNeighbours = Neighbours::kWanted>
class NearbyFit {
 public:
  NearbyFit() {
    points_m_.fill(Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  }

  /// query_m: map frame. reach_m: largest distance of the last neighbour, at most the map's own.
  /// fit(neighbours): a Fit or nothing, for at least k neighbours. map and fit: the same in every
  /// call.
  template <typename Make>
  std::optional<Fit> at(const FeatureMap& map, const Eigen::Vector3f& query_m, double reach_m,
                        const Make& fit) {
    const auto reach = static_cast<float>(reach_m);
    const float moved_m = (query_m - query_m_).norm();
    if (last_m_ - moved_m > reach) return std::nullopt;
    if (moved_m < same_within_m_ && last_m_ + moved_m <= reach) return fit_;
    const bool enough = search(map, query_m, reach, fit);
    return enough && last_m_ <= reach ? fit_ : std::nullopt;
  }

 private:
  /// Whether k points were found.
  template <typename Make>
  bool search(const FeatureMap& map, const Eigen::Vector3f& query_m, float reach_m,
              const Make& fit) {
    constexpr float kFartherThanReach = 1.2F;  // so that a feature that moves needs no new search
    Neighbours found = kept_.nearest(query_m);
    if (found.count < kNeighbours && found.sixth_squared_m2 <= reach_m * reach_m) {
      kept_ = map.nearby(query_m, std::min(kFartherThanReach * reach_m, map.max_distance_m()));
      found = kept_.nearest(query_m);
    }
    const bool enough = found.count >= kNeighbours;
    float next_m2 = found.sixth_squared_m2;
    if constexpr (kNeighbours < Neighbours::kWanted) {
      if (found.count > kNeighbours) next_m2 = found.squared_distance_m2[kNeighbours];
    }
    query_m_ = query_m;
    last_m_ = std::sqrt(enough ? found.squared_distance_m2[kNeighbours - 1] : next_m2);
    same_within_m_ = enough ? (std::sqrt(next_m2) - last_m_) / 2.0F : 0.0F;
    if (!enough || std::equal(points_m_.begin(), points_m_.end(), found.points_m.begin())) {
      return enough;
    }
    std::copy_n(found.points_m.begin(), kNeighbours, points_m_.begin());
    fit_ = fit(found);
    return true;
  }

  NearbyPoints kept_;  ///< by the last search; none at first
  Eigen::Vector3f query_m_ = Eigen::Vector3f::Zero();
  float last_m_ = 0.0F;         ///< the least that it can be if fewer than k were found
  float same_within_m_ = 0.0F;  ///< about query_m_; 0: not searched yet
  std::optional<Fit> fit_;
  std::array<Eigen::Vector3f, kNeighbours> points_m_;  ///< of the fit; NaN before the first
};

}  // namespace hqslam::slam
