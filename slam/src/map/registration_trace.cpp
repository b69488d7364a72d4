#include "map/registration_trace.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "alignment/robust_weights.h"
#include "front_end/motion_correction.h"
#include "map/map_constraints.h"

namespace hqslam::slam {

namespace {

/// The pixel whose point is nearest, the first of several; 0 if the cloud has no return.
std::size_t nearest_pixel(const OrganizedCloud& cloud, const Eigen::Vector3f& point_m) {
  std::size_t nearest = 0;
  float nearest_m2 = std::numeric_limits<float>::infinity();
  for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
    if (cloud.range_m[pixel] <= 0.0F) continue;
    const float away_m2 = (cloud.points_m[pixel] - point_m).squaredNorm();
    if (away_m2 >= nearest_m2) continue;
    nearest_m2 = away_m2;
    nearest = pixel;
  }
  return nearest;
}

/// The features of a kind as measured, at their pixels.
void trace_kind(FeatureKind kind, const std::vector<FeaturePoint>& points, ScanTrace& trace) {
  const auto columns = static_cast<std::size_t>(trace.cloud.columns);
  for (const FeaturePoint& point : points) {
    const std::size_t pixel = nearest_pixel(trace.cloud, point.point_m);
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
  trace.features.clear();
  trace_kind(FeatureKind::kGround, features.ground_to_register, trace);
  trace_kind(FeatureKind::kSurface, features.surfaces_to_register, trace);
  trace_kind(FeatureKind::kEdge, features.edges, trace);
  trace_kind(FeatureKind::kPost, features.posts_to_register, trace);
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
