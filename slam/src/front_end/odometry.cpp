#include "front_end/odometry.h"

#include <cmath>
#include <optional>

#include "alignment/rigid_alignment.h"

namespace hqslam::slam {

namespace {

constexpr int kSearches = 8;
/// From this iteration on, distant matches lose weight and the search is narrower.
constexpr int kRobustFromIteration = 2;
constexpr double kWideSearch_m = 5.0;  // as in LeGO-LOAM
constexpr double kNarrowSearch_m = 1.5;
constexpr double kMinWeight = 0.1;  // as in LeGO-LOAM
constexpr int kStepsPerSearch = 3;
constexpr int kFewestCorrespondences = 10;  // of a step, as in LeGO-LOAM
// A step that changes the motion by less ends the odometry; LeGO-LOAM: 0.1 degrees, 0.001 m.
constexpr double kLastStep_rad = 0.0017453292519943296;
constexpr double kLastStep_m = 0.005;

/// The parameters of a search, except the point.
struct SearchState {
  Pose T_reference_sensor;
  double max_distance_m;
  bool robust;
};

/// A plane through the nearest point, its neighbour in the same row and one in a row nearby.
std::optional<PlaneConstraint> match_plane(const RowOrderedCloud& target,
                                           const Eigen::Vector3f& point_m,
                                           const SearchState& state) {
  const Eigen::Vector3d point = point_m.cast<double>();
  const Eigen::Vector3d moved = state.T_reference_sensor * point;
  const RowQuery query(moved.cast<float>());
  const auto first = target.nearest(query, state.max_distance_m);
  if (!first) return std::nullopt;
  const auto second = target.nearest_in_row_of(*first, query, state.max_distance_m);
  const auto third = target.nearest_near_row_of(*first, query, state.max_distance_m);
  if (!second || !third) return std::nullopt;
  const Eigen::Vector3d a = target.point_m(*first).cast<double>();
  const Eigen::Vector3d b = target.point_m(*second).cast<double>();
  const Eigen::Vector3d c = target.point_m(*third).cast<double>();
  const Eigen::Vector3d cross = (b - a).cross(c - a);
  if (!(cross.norm() > 1e-6)) return std::nullopt;
  PlaneConstraint constraint{point, cross.normalized(), 0.0, 1.0};
  constraint.offset_m = constraint.normal.dot(a);
  const double distance_m = std::abs(constraint.normal.dot(moved) - constraint.offset_m);
  if (state.robust) constraint.weight = 1.0 - 1.8 * distance_m / std::sqrt(point.norm());
  if (constraint.weight < kMinWeight) return std::nullopt;
  return constraint;
}

/// The line through the nearest point and one in a row nearby, as two planes.
std::optional<EdgeConstraints> match_edge(const RowOrderedCloud& target,
                                          const Eigen::Vector3f& point_m,
                                          const SearchState& state) {
  const Eigen::Vector3d point = point_m.cast<double>();
  const Eigen::Vector3d moved = state.T_reference_sensor * point;
  const RowQuery query(moved.cast<float>());
  const auto first = target.nearest(query, state.max_distance_m);
  if (!first) return std::nullopt;
  const auto second = target.nearest_near_row_of(*first, query, state.max_distance_m);
  if (!second) return std::nullopt;
  const Eigen::Vector3d a = target.point_m(*first).cast<double>();
  const Eigen::Vector3d along = target.point_m(*second).cast<double>() - a;
  if (!(along.norm() > 1e-3)) return std::nullopt;
  const Eigen::Vector3d direction = along.normalized();
  const double distance_m = direction.cross(moved - a).norm();
  const double weight = state.robust ? 1.0 - 1.8 * distance_m : 1.0;
  if (weight < kMinWeight) return std::nullopt;
  return edge_constraints(point, a, direction, weight);
}

/// One constraint or none per feature, searched in parallel.
template <typename Find>
ConstraintList find_all(const std::vector<FeaturePoint>& features, const Twist& velocity,
                        const Find& find) {
  const MotionCorrection corrected({velocity});
  std::vector<decltype(find(Eigen::Vector3f()))> found(features.size());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < features.size(); ++i) {
    found[i] = find(corrected(features[i]));
  }
  ConstraintList list;
  list.add(found);
  return list;
}

/// One of the two steps: LM over the free parameters; unobservable directions are held. Returns
/// whether all were observable.
bool improve(const std::vector<PlaneConstraint>& constraints, FreeParameters free,
             Pose& T_reference_sensor) {
  const MotionParameters start = parameters_of(T_reference_sensor);
  const MotionParameters end = align(constraints, start, free, kStepsPerSearch);
  const Observability observable = observability(constraints, free);
  T_reference_sensor = pose_of(without_unobservable(start, end, observable));
  return observable.degenerate_directions == 0;
}

}  // namespace

OdometryTarget::OdometryTarget(const Features& features, const ScanMotion& motion) {
  const auto ordered = [&](const std::vector<FeaturePoint>& points) {
    return RowOrderedCloud(points, motion_corrected(points, motion));
  };
#pragma omp parallel sections
  {
#pragma omp section
    ground = ordered(features.ground);
#pragma omp section
    edges = ordered(features.edges);
  }
}

OdometryResult scan_to_scan(const OdometryTarget& reference, const Features& features,
                            const PredictedMotion& predicted) {
  OdometryResult result;
  result.T_reference_sensor = predicted.T_reference_sensor;
  result.status = Status::kTooFewFeatures;
  const bool has_edges = static_cast<int>(reference.edges.size()) >= kFewestEdges;
  const bool has_ground = static_cast<int>(reference.ground.size()) >= kFewestPlanar;
  if (!has_edges && !has_ground) return result;
  for (int iteration = 0; iteration < kSearches; ++iteration) {
    const Pose before = result.T_reference_sensor;
    const Twist velocity = (1.0 / predicted.duration_s) * logarithm(before);
    const bool robust = iteration >= kRobustFromIteration;
    const double reach_m = robust ? kNarrowSearch_m : kWideSearch_m;

    const SearchState planar_state{before, reach_m, robust};
    const ConstraintList planar = find_all(
        features.flat_points, velocity,
        [&](const auto& point_m) { return match_plane(reference.ground, point_m, planar_state); });
    result.planar_correspondences = planar.planes;
    const bool enough_planar = has_ground && planar.planes >= kFewestCorrespondences;
    const bool planar_observable =
        !enough_planar ||
        improve(planar.all, FreeParameters::kOutOfPlane, result.T_reference_sensor);

    const SearchState edge_state{result.T_reference_sensor, reach_m, robust};
    const ConstraintList edges = find_all(features.sharp_edges, velocity, [&](const auto& point_m) {
      return match_edge(reference.edges, point_m, edge_state);
    });
    result.edge_correspondences = edges.edges;
    const bool enough_edges = has_edges && edges.edges >= kFewestCorrespondences;
    // Without ground, edges estimate all six parameters as far as they can.
    const FreeParameters free = enough_planar ? FreeParameters::kInPlane : FreeParameters::kAll;
    const bool edges_observable =
        !enough_edges || improve(edges.all, free, result.T_reference_sensor);

    if (!enough_edges) {
      result.status = Status::kTooFewFeatures;
      if (!enough_planar) return result;
      continue;
    }
    result.status =
        planar_observable && edges_observable ? Status::kNotConverged : Status::kDegenerate;
    const Pose change = before.inverse() * result.T_reference_sensor;
    if (iteration > kRobustFromIteration && rotation_angle_rad(change) < kLastStep_rad &&
        change.translation().norm() < kLastStep_m) {
      if (result.status == Status::kNotConverged) result.status = Status::kOk;
      break;
    }
  }
  return result;
}

}  // namespace hqslam::slam
