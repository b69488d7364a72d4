#include "hqslam/slam/mapping.h"

#include <cmath>
#include <optional>

#include "map_matching.h"
#include "rigid_alignment.h"
#include "voxel_thinning.h"

namespace hqslam::slam {

namespace {

constexpr double kMinWeight = 0.1;
constexpr int kStepsPerSearch = 2;

// Constraints are of the motion that remains, in axes of the map with the predicted position as
// origin: points are R p, planes are moved by -t.

std::optional<EdgeConstraints> match_edge(const FeatureMap& map, const Eigen::Vector3d& rotated_m,
                                          const Eigen::Vector3d& origin_m) {
  const auto line = fit_line(map.nearest((rotated_m + origin_m).cast<float>()));
  if (!line) return std::nullopt;
  const Eigen::Vector3d on_line_m = line->point_m - origin_m;
  const double distance_m = line->direction.cross(rotated_m - on_line_m).norm();
  const double weight = 1.0 - 0.9 * distance_m;
  if (weight < kMinWeight) return std::nullopt;
  return edge_constraints(rotated_m, on_line_m, line->direction, weight);
}

std::optional<PlaneConstraint> match_plane(const FeatureMap& map, const Eigen::Vector3d& rotated_m,
                                           const Eigen::Vector3d& origin_m, double max_residual_m) {
  const auto plane = fit_plane(map.nearest((rotated_m + origin_m).cast<float>()), max_residual_m);
  if (!plane) return std::nullopt;
  const double offset_m = plane->normal.dot(plane->point_m - origin_m);
  const double distance_m = std::abs(plane->normal.dot(rotated_m) - offset_m);
  const double weight = 1.0 - 0.9 * distance_m / std::sqrt(rotated_m.norm());
  if (weight < kMinWeight) return std::nullopt;
  return PlaneConstraint{rotated_m, plane->normal, offset_m, weight};
}

ConstraintList match(const MapFeatures& scan, const FeatureMap& edge_map,
                     const FeatureMap& plane_map, const Pose& T_map_sensor,
                     const SensorMotion& motion, const MappingOptions& options) {
  const std::vector<Eigen::Vector3f> edges_m = motion_corrected(scan.edges, motion);
  const std::vector<Eigen::Vector3f> planes_m = motion_corrected(scan.planes_to_locate, motion);
  std::vector<std::optional<EdgeConstraints>> edges(edges_m.size());
  std::vector<std::optional<PlaneConstraint>> planes(planes_m.size());
  const Eigen::Matrix3d rotation = T_map_sensor.linear();
  const Eigen::Vector3d origin_m = T_map_sensor.translation();
#pragma omp parallel
  {
#pragma omp for schedule(static) nowait
    for (std::size_t i = 0; i < edges_m.size(); ++i) {
      edges[i] = match_edge(edge_map, rotation * edges_m[i].cast<double>(), origin_m);
    }
#pragma omp for schedule(static)
    for (std::size_t i = 0; i < planes_m.size(); ++i) {
      planes[i] = match_plane(plane_map, rotation * planes_m[i].cast<double>(), origin_m,
                              options.max_plane_residual_m);
    }
  }
  ConstraintList result;
  result.add(edges);
  result.add(planes);
  return result;
}

}  // namespace

MapFeatures map_features(const Features& features, const MappingOptions& options) {
  std::vector<FeaturePoint> planes = features.ground;
  planes.insert(planes.end(), features.surfaces.begin(), features.surfaces.end());
  MapFeatures result;
  result.edges = thin(features.edges, options.edge_leaf_m);
  result.planes = thin(planes, options.planar_leaf_m);
  result.planes_to_locate = thin(result.planes, options.located_planar_leaf_m);
  return result;
}

Mapping::Mapping(const MappingOptions& options)
    : options_(options),
      edges_(options.edge_leaf_m, options.max_neighbour_distance_m),
      planes_(options.planar_leaf_m, options.max_neighbour_distance_m) {}

MappingResult Mapping::locate(const MapFeatures& features, const Pose& T_map_sensor_predicted,
                              const PreviousPose& previous) const {
  const auto feature_count =
      static_cast<double>(features.edges.size() + features.planes_to_locate.size());
  MappingResult result;
  result.T_map_sensor = T_map_sensor_predicted;
  for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
    const SensorMotion motion{previous.T_map_sensor.inverse() * result.T_map_sensor,
                              previous.duration_s};
    const ConstraintList constraints =
        match(features, edges_, planes_, result.T_map_sensor, motion, options_);
    result.edge_correspondences = constraints.edges;
    result.planar_correspondences = constraints.planes;
    const int matched = constraints.edges + constraints.planes;
    if (matched < options_.min_correspondences ||
        matched < options_.min_matched_share * feature_count) {
      result.T_map_sensor = T_map_sensor_predicted;
      result.status = Status::kTooFewFeatures;
      return result;
    }
    const MotionParameters found =
        align(constraints.all, MotionParameters{}, FreeParameters::kAll, kStepsPerSearch);
    const Observability observable = observability(constraints.all, FreeParameters::kAll);
    const Pose change = pose_of(without_unobservable(MotionParameters{}, found, observable));
    result.T_map_sensor.linear() = change.linear() * result.T_map_sensor.linear();
    result.T_map_sensor.translation() += change.translation();
    const bool converged = rotation_angle_rad(change) < options_.converged_rotation_rad &&
                           change.translation().norm() < options_.converged_translation_m;
    result.status = observable.degenerate_directions > 0 ? Status::kDegenerate
                    : converged                          ? Status::kOk
                                                         : Status::kNotConverged;
    if (converged) break;
  }
  result.T_map_sensor = orthonormalized(result.T_map_sensor);
  return result;
}

bool Mapping::is_key_frame(const Pose& T_map_sensor) const {
  if (!has_key_frame_) return true;
  const Pose motion = T_map_last_key_frame_.inverse() * T_map_sensor;
  return motion.translation().norm() >= options_.key_frame_translation_m ||
         rotation_angle_rad(motion) >= options_.key_frame_rotation_rad;
}

void Mapping::insert(const MapFeatures& features, const Pose& T_map_sensor,
                     const SensorMotion& motion) {
  const auto in_map = [&](const std::vector<FeaturePoint>& points) {
    std::vector<Eigen::Vector3f> result = motion_corrected(points, motion);
    for (Eigen::Vector3f& point_m : result) {
      point_m = (T_map_sensor * point_m.cast<double>()).cast<float>();
    }
    return result;
  };
  edges_.insert(in_map(features.edges));
  planes_.insert(in_map(features.planes));
  T_map_last_key_frame_ = T_map_sensor;
  has_key_frame_ = true;
}

}  // namespace hqslam::slam
