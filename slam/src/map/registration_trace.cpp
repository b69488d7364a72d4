#include "map/registration_trace.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "alignment/robust_weights.h"
#include "front_end/motion_correction.h"
#include "map/map_constraints.h"

namespace hqslam::slam {

namespace {

/// The pixel nearest to a point. A pixel whose range differs by d is at least d away, so pixels are
/// visited from the point's own range outwards until none can be nearer.
class NearestPixel {
 public:
  explicit NearestPixel(const OrganizedCloud& cloud) : cloud_(cloud) {
    for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
      if (cloud.range_m[pixel] > 0.0F) by_range_.emplace_back(cloud.points_m[pixel].norm(), pixel);
    }
    std::ranges::sort(by_range_);
  }

  /// The first of several at equal distance; 0 if the cloud has no return.
  std::size_t of(const Eigen::Vector3f& point_m) const {
    const float range_m = point_m.norm();
    const auto start = std::ranges::lower_bound(by_range_, std::pair(range_m, std::size_t(0)));
    std::pair nearest(std::numeric_limits<float>::infinity(), std::size_t(0));  // distance^2, pixel
    const auto is_last = [&](const std::pair<float, std::size_t>& at) {
      const float apart_m = kRounding * (at.first - range_m);
      if (apart_m * apart_m > nearest.first) return true;
      nearest = std::min(
          nearest, std::pair((cloud_.points_m[at.second] - point_m).squaredNorm(), at.second));
      return false;
    };
    for (auto at = start; at != by_range_.end() && !is_last(*at); ++at) continue;
    for (auto at = start; at != by_range_.begin() && !is_last(*std::prev(at)); --at) continue;
    return nearest.second;
  }

 private:
  static constexpr float kRounding = 0.999F;
  const OrganizedCloud& cloud_;
  std::vector<std::pair<float, std::size_t>> by_range_;
};

/// The features of a kind as measured, at their pixels.
void trace_kind(FeatureKind kind, const std::vector<FeaturePoint>& points,
                const NearestPixel& nearest, ScanTrace& trace) {
  const auto columns = static_cast<std::size_t>(trace.cloud.columns);
  for (const FeaturePoint& point : points) {
    const std::size_t pixel = nearest.of(point.point_m);
    TracedFeature feature;
    feature.kind = kind;
    feature.row = static_cast<int>(pixel / columns);
    feature.column = static_cast<int>(pixel % columns);
    feature.point_m = point.point_m;
    trace.features.push_back(feature);
  }
}

/// The step from a point to its plane, or to its line.
Eigen::Vector3d step_to(const PlaneConstraint& plane) {
  const double distance_m = plane.normal.dot(plane.point_m) - plane.offset_m;
  return -distance_m * plane.normal / std::max(plane.normal.norm(), 1e-9);
}
Eigen::Vector3d step_to(const EdgeConstraints& edge) { return step_to(edge[0]) + step_to(edge[1]); }
const PlaneConstraint& first_of(const PlaneConstraint& plane) { return plane; }
const PlaneConstraint& first_of(const EdgeConstraints& edge) { return edge[0]; }

template <typename Constraint>
void trace_matches(const std::vector<std::optional<Constraint>>& matches,
                   const Eigen::Vector3d& origin_m, TracedFeature* feature) {
  for (const std::optional<Constraint>& match : matches) {
    TracedFeature& traced = *feature++;
    if (!match) continue;
    const PlaneConstraint& plane = first_of(*match);
    traced.is_matched = true;
    const Eigen::Vector3d on_map_m = origin_m + plane.point_m + step_to(*match);
    traced.on_map_m = on_map_m.cast<float>();
    traced.residual_m = distance_m(*match);
    traced.weight_per_m = plane.weight;
  }
}

/// The features of a kind, corrected for motion and unmatched. Out: the next feature.
TracedFeature* correct_kind(const std::vector<FeaturePoint>& points, const ScanMotion& motion,
                            TracedFeature* feature) {
  for (const Eigen::Vector3f& point_m : motion_corrected(points, motion)) {
    *feature = {feature->kind, feature->row, feature->column, point_m};
    ++feature;
  }
  return feature;
}

}  // namespace

void trace_features(const MapFeatures& features, ScanTrace& trace) {
  const NearestPixel nearest(trace.cloud);
  trace.features.clear();
  trace_kind(FeatureKind::kGround, features.ground_to_register, nearest, trace);
  trace_kind(FeatureKind::kSurface, features.surfaces_to_register, nearest, trace);
  trace_kind(FeatureKind::kEdge, features.edges, nearest, trace);
  trace_kind(FeatureKind::kPost, features.posts_to_register, nearest, trace);
}

void trace_registration(const Mapping& mapping, const MapFeatures& features,
                        const MappingResult& found, ScanTrace& trace) {
  TracedFeature* traced = trace.features.data();
  for (const auto* points : {&features.ground_to_register, &features.surfaces_to_register,
                             &features.edges, &features.posts_to_register}) {
    traced = correct_kind(*points, found.state.within_scan(), traced);
  }
  trace.inlier_ratio = found.inlier_ratio;
  const MapMatches matches = mapping.matches(features, found);
  const Eigen::Vector3d origin_m = found.state.T_map_sensor.translation();
  TracedFeature* feature = trace.features.data();
  trace_matches(matches.ground, origin_m, feature);
  trace_matches(matches.surfaces, origin_m, feature += matches.ground.size());
  trace_matches(matches.edges, origin_m, feature += matches.surfaces.size());
  trace_matches(matches.posts, origin_m, feature += matches.edges.size());
  const Observability observable = observability(matches.constraints().all, FreeParameters::kAll);
  trace.direction_share = observable.share;
  trace.direction = observable.direction;
  trace.degenerate_directions = observable.degenerate_directions;
}

}  // namespace hqslam::slam
