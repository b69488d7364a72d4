#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "city.h"
#include "traffic.h"

namespace hqslam::sim {

/// The first hit of a ray.
struct RayHit {
  double range_m = 0.0;
  double cos_incidence = 1.0;  ///< of the angle between the ray and the surface's normal, 0..1
  Surface surface;
};

/// The city and its actors, ready for rays (Embree). Embree finds the triangle that a ray hits; the
/// intersection is computed here, because Embree's own arithmetic differs between processors.
class RayScene {
 public:
  explicit RayScene(const Scenery& scenery);
  ~RayScene();

  /// Sets the actors of the next scan; only the first `kMostActors` are used.
  void place_actors(const std::vector<ActorMotion>& actors);
  /// `direction` has length 1; `scan_fraction` 0..1 is the time within the scan. May be called from
  /// many threads at once.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                             double scan_fraction, double max_range_m) const;

  /// Distance from a point to the nearest standing surface; nothing if it exceeds `reach_m`. May be
  /// called from many threads at once.
  std::optional<double> distance_m(const Eigen::Vector3d& point_m, double reach_m) const;

  static constexpr std::size_t kMostActors = 40;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::sim
