#include "hqslam/slam/mapping.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "map_matching.h"
#include "nearby_fit.h"
#include "rigid_alignment.h"
#include "voxel_thinning.h"

namespace hqslam::slam {

namespace {

constexpr double kMinWeight = 0.1;
/// Cosine of the steepest ground's angle with the sensor's.
constexpr double kMinGroundUprightness = 0.9;
/// So many points of the ground tell the height well enough to ask nothing else about it.
constexpr int kMinGroundConstraints = 100;
constexpr int kStepsPerSearch = 2;

/// Searches of wide reach, before the pose is good enough for the narrow one.
constexpr int kWideSearches = 2;

// Constraints are of the motion that remains, in axes of the map with the predicted position as
// origin: points are R p, planes are moved by -t.

std::optional<EdgeConstraints> match_edge(const std::optional<MapLine>& line,
                                          const Eigen::Vector3d& rotated_m,
                                          const Eigen::Vector3d& origin_m) {
  if (!line) return std::nullopt;
  const Eigen::Vector3d on_line_m = line->point_m - origin_m;
  const double distance_m = line->direction.cross(rotated_m - on_line_m).norm();
  const double weight = 1.0 - 0.9 * distance_m;
  if (weight < kMinWeight) return std::nullopt;
  return edge_constraints(rotated_m, on_line_m, line->direction, weight);
}

std::optional<PlaneConstraint> match_surface(const std::optional<MapPlane>& plane,
                                             const Eigen::Vector3d& rotated_m,
                                             const Eigen::Vector3d& origin_m) {
  if (!plane) return std::nullopt;
  const double offset_m = plane->normal.dot(plane->point_m - origin_m);
  const double distance_m = std::abs(plane->normal.dot(rotated_m) - offset_m);
  const double weight = 1.0 - 0.9 * distance_m / std::sqrt(rotated_m.norm());
  if (weight < kMinWeight) return std::nullopt;
  return PlaneConstraint{rotated_m, plane->normal, offset_m, weight};
}

/// Keeps of a ground plane what it tells about height, roll and pitch.
///
/// A ring on the ground lies in the map beside the rings of earlier scans. The slope of a plane
/// through points of two rings a few decimetres apart is mostly noise, and its horizontal part
/// pulls the scan's ring towards the map's: against the motion. So the normal n is replaced by its
/// part along the sensor's vertical u, n' = (n . u) u, with the distance of the point left as it
/// is.
std::optional<PlaneConstraint> upright(std::optional<PlaneConstraint> ground,
                                       const Eigen::Vector3d& vertical) {
  if (!ground) return std::nullopt;
  const double distance_m = ground->normal.dot(ground->point_m) - ground->offset_m;
  const double share = ground->normal.dot(vertical);
  if (std::abs(share) < kMinGroundUprightness) return std::nullopt;
  ground->normal = share * vertical;
  ground->offset_m = ground->normal.dot(ground->point_m) - distance_m;
  return ground;
}

/// Keeps of a surface's plane what it tells about x, y, yaw and, by its lever, roll and pitch.
///
/// What is not ground stands upright, mostly. Where it does not - kerbs, cars, leaves, ground that
/// was not recognised - five points of rows that are far apart make a slope of chance, and slopes
/// of chance, all of them seen from the same side, tilt the map scan by scan. So the normal n loses
/// its part along the sensor's vertical u, n' = n - (n . u) u, with the distance of the point left
/// as it is: height comes from the ground alone.
std::optional<PlaneConstraint> horizontal(std::optional<PlaneConstraint> surface,
                                          const Eigen::Vector3d& vertical) {
  if (!surface) return std::nullopt;
  const double distance_m = surface->normal.dot(surface->point_m) - surface->offset_m;
  surface->normal -= surface->normal.dot(vertical) * vertical;
  surface->offset_m = surface->normal.dot(surface->point_m) - distance_m;
  return surface;
}

/// A kind of features with what is near each of them in the map.
template <typename Fit>
struct SearchedFeatures {
  const std::vector<FeaturePoint>& features;
  std::vector<NearbyFit<Fit>> nearby;

  explicit SearchedFeatures(const std::vector<FeaturePoint>& searched)
      : features(searched), nearby(searched.size()) {}
};

/// The features of a scan while it is located.
struct LocatedScan {
  SearchedFeatures<MapPlane> ground;
  SearchedFeatures<MapPlane> surfaces;
  SearchedFeatures<MapLine> edges;
};

/// Where a scan is believed to be, and how far about its features the map is searched: five
/// neighbours that are farther apart are seldom of one surface.
struct SearchState {
  Pose T_map_sensor;
  SensorMotion motion;
  double reach_m;
};

/// One constraint or none per feature, searched in parallel: constrain(fit, rotated_m).
template <typename Fit, typename Make, typename Constrain>
void add_all(SearchedFeatures<Fit>& searched, const SearchState& state, const FeatureMap& map,
             const Make& make, const Constrain& constrain, ConstraintList& list) {
  const std::vector<Eigen::Vector3f> points_m = motion_corrected(searched.features, state.motion);
  const Eigen::Matrix3d rotation = state.T_map_sensor.linear();
  const Eigen::Vector3d origin_m = state.T_map_sensor.translation();
  std::vector<decltype(constrain(std::optional<Fit>(), Eigen::Vector3d()))> found(points_m.size());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Eigen::Vector3d rotated_m = rotation * points_m[i].cast<double>();
    const Eigen::Vector3f query_m = (rotated_m + origin_m).cast<float>();
    found[i] = constrain(searched.nearby[i].at(map, query_m, state.reach_m, make), rotated_m);
  }
  list.add(found);
}

ConstraintList match(LocatedScan& scan, const SearchState& state, const FeatureMap& edge_map,
                     const FeatureMap& plane_map, const MappingOptions& options) {
  const Eigen::Vector3d origin_m = state.T_map_sensor.translation();
  const Eigen::Vector3d vertical = state.T_map_sensor.linear().col(2);
  const auto flat_ground = [&](const Neighbours& neighbours) {
    return fit_plane(neighbours, options.max_ground_residual_m);
  };
  const auto plane = [&](const Neighbours& neighbours) {
    return fit_plane(neighbours, options.max_plane_residual_m);
  };
  ConstraintList list;
  add_all(
      scan.ground, state, plane_map, flat_ground,
      [&](const auto& near, const Eigen::Vector3d& rotated_m) {
        return upright(match_surface(near, rotated_m, origin_m), vertical);
      },
      list);
  const bool ground_tells_height = list.planes >= kMinGroundConstraints;
  add_all(
      scan.surfaces, state, plane_map, plane,
      [&](const auto& near, const Eigen::Vector3d& rotated_m) {
        const auto constraint = match_surface(near, rotated_m, origin_m);
        return ground_tells_height ? horizontal(constraint, vertical) : constraint;
      },
      list);
  add_all(
      scan.edges, state, edge_map, fit_line,
      [&](const auto& line, const Eigen::Vector3d& rotated_m) {
        return match_edge(line, rotated_m, origin_m);
      },
      list);
  return list;
}

std::vector<FeaturePoint> measured(const std::vector<FeaturePoint>& features,
                                   const std::optional<RowSelection>& rows) {
  if (!rows) return features;
  std::vector<FeaturePoint> result;
  std::copy_if(features.begin(), features.end(), std::back_inserter(result),
               [&](const FeaturePoint& feature) { return rows->contains(feature.row); });
  return result;
}

}  // namespace

MapFeatures map_features(const Features& features, const std::optional<RowSelection>& measured_rows,
                         const MappingOptions& options) {
  MapFeatures result;
  result.edges = thin(measured(features.edges, measured_rows), options.edge_leaf_m);
  result.ground = thin(measured(features.ground, measured_rows), options.planar_leaf_m);
  result.surfaces = thin(measured(features.surfaces, measured_rows), options.planar_leaf_m);
  result.ground_to_locate = thin(result.ground, options.located_planar_leaf_m);
  result.surfaces_to_locate = thin(result.surfaces, options.located_planar_leaf_m);
  return result;
}

Mapping::Mapping(const MappingOptions& options)
    : options_(options),
      edges_(options.edge_leaf_m, options.max_neighbour_distance_m),
      planes_(options.planar_leaf_m, options.max_neighbour_distance_m) {}

MappingResult Mapping::locate(const MapFeatures& features, const Pose& T_map_sensor_predicted,
                              const PreviousPose& previous) const {
  const auto feature_count =
      static_cast<double>(features.edges.size() + features.ground_to_locate.size() +
                          features.surfaces_to_locate.size());
  MappingResult result;
  result.T_map_sensor = T_map_sensor_predicted;
  LocatedScan scan{SearchedFeatures<MapPlane>(features.ground_to_locate),
                   SearchedFeatures<MapPlane>(features.surfaces_to_locate),
                   SearchedFeatures<MapLine>(features.edges)};
  bool narrow_suffices = true;
  for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
    const SensorMotion motion{previous.T_map_sensor.inverse() * result.T_map_sensor,
                              previous.duration_s};
    const bool narrow = iteration >= kWideSearches && narrow_suffices;
    const double reach_m =
        narrow ? options_.close_neighbour_distance_m : options_.max_neighbour_distance_m;
    const ConstraintList constraints =
        match(scan, {result.T_map_sensor, motion, reach_m}, edges_, planes_, options_);
    const int matched = constraints.edges + constraints.planes;
    const bool enough = matched >= options_.min_correspondences &&
                        matched >= options_.min_matched_share * feature_count;
    const Observability observable = observability(constraints.all, FreeParameters::kAll);
    if (narrow && (!enough || observable.degenerate_directions > 0)) {
      narrow_suffices = false;
      continue;
    }
    result.edge_correspondences = constraints.edges;
    result.planar_correspondences = constraints.planes;
    if (!enough) {
      result.T_map_sensor = T_map_sensor_predicted;
      result.status = Status::kTooFewFeatures;
      return result;
    }
    const MotionParameters found =
        align(constraints.all, MotionParameters{}, FreeParameters::kAll, kStepsPerSearch);
    const Pose change = pose_of(without_unobservable(MotionParameters{}, found, observable));
    result.T_map_sensor.linear() = change.linear() * result.T_map_sensor.linear();
    result.T_map_sensor.translation() += change.translation();
    const bool converged = rotation_angle_rad(change) < options_.converged_rotation_rad &&
                           change.translation().norm() < options_.converged_translation_m;
    result.status = observable.degenerate_directions > 0 ? Status::kDegenerate
                    : converged                          ? Status::kOk
                                                         : Status::kNotConverged;
    if (converged && (narrow || !narrow_suffices)) break;
  }
  result.T_map_sensor = orthonormalized(result.T_map_sensor);
  return result;
}

bool Mapping::is_key_frame(const Pose& T_map_sensor) const {
  if (key_frames_ == 0) return true;
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
  edges_.insert(in_map(features.edges), key_frames_);
  planes_.insert(in_map(features.ground), key_frames_);
  planes_.insert(in_map(features.surfaces), key_frames_);
  T_map_last_key_frame_ = T_map_sensor;
  ++key_frames_;
}

Mapping Mapping::older_part(const Eigen::Vector3d& centre_m, double radius_m,
                            std::uint32_t key_frames) const {
  Mapping result(options_);
  if (key_frames == 0) return result;
  result.edges_.insert(edges_.points_near_m(centre_m, radius_m, key_frames - 1));
  result.planes_.insert(planes_.points_near_m(centre_m, radius_m, key_frames - 1));
  return result;
}

void Mapping::correct(const std::vector<Pose>& corrections) {
  edges_.correct(corrections);
  planes_.correct(corrections);
  T_map_last_key_frame_ = orthonormalized(corrections.back() * T_map_last_key_frame_);
}

}  // namespace hqslam::slam
