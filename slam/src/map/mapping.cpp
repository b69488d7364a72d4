#include "map/mapping.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "alignment/rigid_alignment.h"
#include "alignment/robust_weights.h"
#include "alignment/scan_information.h"
#include "alignment/velocity_information.h"
#include "front_end/motion_correction.h"
#include "front_end/voxel_thinning.h"

namespace hqslam::slam {

namespace {

/// Largest distance of neighbours in narrow searches. Chosen in simulation alone. LeGO-LOAM: 1 m.
constexpr double kNarrowReach_m = 0.6;
/// Motion from one keyframe to the next; the rotation is LIO-SAM's, LeGO-LOAM has none.
constexpr double kKeyframe_m = 0.3;
constexpr double kKeyframe_rad = 0.2;
/// Maximum number of wide searches before the narrow ones begin. Chosen in simulation alone.
constexpr int kWideSearches = 2;
/// A step of a wide search that moves no point up to kLever_m away by more leaves a pose that is
/// good enough, too. With 0.05 a real drive is less accurate (weights/NOTEBOOK.md, "Speed").
constexpr double kGoodEnough_m = 0.03;
/// A step that changes the pose by less is the last: 0.05 degrees, as in LeGO-LOAM.
constexpr double kConverged_rad = 0.0008726646259971648;
constexpr double kConverged_m = 0.0005;
/// Most scans need fewer iterations. After these some oscillate between the same neighbours: then
/// steps of kLateTolerance times the tolerance count as converged: without it the real handheld OS0
/// is less accurate.
constexpr int kUsualIterations = 10;
constexpr double kLateTolerance = 4.0;
/// Smallest share of features that match the map in a registered scan: in simulated streets 0.47
/// and more do, of noise 0.2. LeGO-LOAM: 0.
constexpr double kLeastMatchedShare = 0.25;
/// Distance from the line or plane for MappingResult::close_ratio: right and wrong places of the
/// real handheld OS0 have 0.5 and 0.2.
constexpr double kClose_m = 0.1;

RegisteredScan searched(const MapFeatures& features) {
  return {SearchedFeatures<MapSurface>(features.ground_to_register),
          SearchedFeatures<MapSurface>(features.surfaces_to_register),
          SearchedFeatures<MapLine>(features.edges),
          SearchedFeatures<Eigen::Vector3d, 1>(features.posts_to_register), features.up};
}

/// MappingResult::close_planes. The ground's planes come first; a feature on a line has two planes.
int close_planes(const ConstraintList& found) {
  return static_cast<int>(
      std::count_if(found.all.begin() + found.ground, found.all.end(),
                    [](const PlaneConstraint& plane) { return distance_m(plane) < kClose_m; }));
}

/// MappingResult::has_near_ground.
bool has_near_ground(const ConstraintList& found) {
  constexpr double kSine = 0.09;  // 5 degrees down; 20 m from a sensor at 1.8 m (simulated decks)
  const auto is_near = [](const PlaneConstraint& plane) {
    return -plane.point_m.z() > kSine * plane.point_m.norm();
  };
  const auto ground = found.all.begin();
  return std::count_if(ground, ground + found.ground, is_near) >= kMinGroundConstraints;
}

/// MappingResult::close_ratio.
double close_share(int close, const MapFeatures& features) {
  const std::size_t sought = features.surfaces_to_register.size() +
                             2 * (features.edges.size() + features.posts_to_register.size());
  return close / std::max(static_cast<double>(sought), 1.0);
}

double standing_features(const MapFeatures& features) {
  return static_cast<double>(features.edges.size() + features.posts_to_register.size() +
                             features.surfaces_to_register.size());
}

/// MappingResult::inlier_ratio of a wide search.
double inlier_share(const ConstraintList& found, const MapFeatures& features) {
  return (found.edges + found.planes - found.ground) / std::max(standing_features(features), 1.0);
}

/// The share of features that match. Of the ground few do in a map of one scan, whose rings hardly
/// make planes: the share of the others counts if it is larger.
double matched_share(const ConstraintList& found, const MapFeatures& features,
                     bool is_map_of_one_scan) {
  const double sought =
      standing_features(features) + static_cast<double>(features.ground_to_register.size());
  const double share = (found.edges + found.planes) / sought;
  return is_map_of_one_scan ? std::max(share, inlier_share(found, features)) : share;
}

void put_matches(const ConstraintList& found, const MapFeatures& features, MappingResult& result) {
  result.edge_correspondences = found.edges;
  result.planar_correspondences = found.planes;
  result.has_ground = found.ground >= kMinGroundConstraints;
  result.has_near_ground = has_near_ground(found);
  result.close_planes = close_planes(found);
  result.close_ratio = close_share(result.close_planes, features);
  if (!result.is_close_search) result.inlier_ratio = inlier_share(found, features);
}

/// Whether a step moves the pose so little that it is the last.
bool has_converged(const Pose& change, int iteration) {
  const double near_enough = iteration < kUsualIterations ? 1.0 : kLateTolerance;
  return rotation_angle_rad(change) < near_enough * kConverged_rad &&
         change.translation().norm() < near_enough * kConverged_m;
}

/// Whether a step of a wide search leaves a pose that is good enough for the narrow one.
bool is_good_enough(const Pose& change) {
  return change.translation().norm() + kLever_m * rotation_angle_rad(change) < kGoodEnough_m;
}

/// Information [1/m^2] that a narrow search with a degenerate direction must have about x, y and
/// yaw; with less the scan is searched widely to the end.
///
/// For a tracked sensor it corresponds to 0.063 m. Beyond it wide searches are less accurate:
/// features far apart are not of one surface. About height and tilt a narrow search has as much
/// information as a wide one, since the ground is searched widely where little of it is near
/// (MapSearch::ground_reach_m).
double enough_in_plane_per_m2(SearchFrom from) {
  return from == SearchFrom::kRecognizedPlace ? std::numeric_limits<double>::infinity() : 250.0;
}

MapSearch search_at(const MappingResult& at, SearchFrom from) {
  const double reach_m = at.is_close_search ? kNarrowReach_m : kMapReach_m;
  return {at.state.T_map_sensor, at.state.within_scan(), reach_m,
          from == SearchFrom::kRecognizedPlace ? reach_m : kMapReach_m, at.is_close_search};
}

}  // namespace

MapFeatures map_features(const Features& features, const MappingOptions& options) {
  MapFeatures result;
  result.up = features.up;
#pragma omp parallel sections
  {
#pragma omp section
    {
      result.surfaces = thin(features.surfaces, options.planar_leaf_m);
      result.surfaces_to_register = thin(result.surfaces, options.located_planar_leaf_m);
    }
#pragma omp section
    {
      result.ground = thin(features.ground, options.planar_leaf_m);
      result.ground_to_register = thin(result.ground, options.located_planar_leaf_m);
    }
#pragma omp section
    {
      result.edges = thin(features.edges, kMapEdgeLeaf_m);
      result.posts = features.posts;
      result.posts_to_register = thin(result.posts, options.located_planar_leaf_m);
    }
  }
  // Where everything is near, as in a room, too few would be left (simulated rooms, the real OS0).
  constexpr std::size_t kFew = 300;
  if (result.ground_to_register.size() < kFew) {
    result.ground_to_register = result.ground;
    if (result.surfaces_to_register.size() < kFew) result.surfaces_to_register = result.surfaces;
  }
  return result;
}

Mapping::Mapping(const MappingOptions& options, std::uint32_t first_keyframe)
    : options_(options), map_(options), keyframes_(first_keyframe) {}

Mapping::Mapping(const MappingOptions& options, FeatureMaps map)
    : options_(options), map_(std::move(map)), is_given_(true) {}

MappingResult Mapping::register_scan(const MapFeatures& features, const MotionState& expected,
                                     const Pose& T_map_sensor_start, SearchFrom from) const {
  MappingResult result;
  const ExpectedState prior(expected);
  result.state = prior.given(T_map_sensor_start);
  const double least_in_plane_per_m2 = enough_in_plane_per_m2(from);
  RegisteredScan scan = searched(features);
  bool narrow_suffices = true;
  std::vector<PlaneConstraint> used;  // by the last step
  Eigen::Matrix3d R_map_before;
  bool is_near = false;  // enough for a narrow search
  for (int iteration = 0; iteration < options_.max_iterations; ++iteration) {
    const bool narrow = (is_near || iteration >= kWideSearches) && narrow_suffices;
    result.is_close_search = narrow;
    ConstraintList constraints =
        match_with_map(scan, search_at(result, from), map_, options_).constraints();
    // Not of a narrow search, which would then end too soon: between long walls a drive was lost.
    const bool is_map_of_one_scan = !narrow && recent_path_m_.size() == 1;
    const bool enough =
        constraints.edges + constraints.planes >= options_.min_correspondences &&
        matched_share(constraints, features, is_map_of_one_scan) >= kLeastMatchedShare;
    const Pose before = result.state.T_map_sensor;
    const ScanInformation information = scan_information(constraints.all, before.linear());
    const bool all_observable = information.degenerate_directions == 0;
    const bool is_known = all_observable || information.least_in_plane > least_in_plane_per_m2;
    if (narrow && !(enough && is_known)) {
      narrow_suffices = false;
      result.is_close_search = false;
      continue;
    }
    put_matches(constraints, features, result);
    if (!enough) {
      result.state = expected;
      result.status = Status::kTooFewFeatures;
      return result;
    }
    if (expected.measured_step_s) {
      const VelocityInformation velocity =
          velocity_information(constraints.all, before.linear(), information);
      prior.improve(result.state, information, &velocity);
    } else {
      prior.improve(result.state, information);
    }
    result.information = information.information;
    used = std::move(constraints.all);
    R_map_before = before.linear();
    const Pose change = before.inverse() * result.state.T_map_sensor;
    is_near = is_good_enough(change);
    const bool converged = has_converged(change, iteration);
    result.status = !all_observable ? Status::kDegenerate
                    : converged     ? Status::kOk
                                    : Status::kNotConverged;
    if (converged && (narrow || !narrow_suffices)) break;
  }
  result.state.T_map_sensor = orthonormalized(result.state.T_map_sensor);
  const KnownInformation known = known_information(used, R_map_before);
  result.known = known.information;
  result.state.covariance = prior.covariance(result.known);
  if (!known.is_complete) result.status = Status::kDegenerate;
  return result;
}

MapMatches Mapping::matches(const MapFeatures& features, const MappingResult& found) const {
  RegisteredScan scan = searched(features);
  return match_with_map(scan, search_at(found, SearchFrom::kExpectedPose), map_, options_);
}

bool Mapping::is_keyframe(const Pose& T_map_sensor) const {
  if (keyframes_ == 0) return true;
  const Pose motion = T_map_last_keyframe_.inverse() * T_map_sensor;
  return motion.translation().norm() >= kKeyframe_m || rotation_angle_rad(motion) >= kKeyframe_rad;
}

void Mapping::insert(const MapFeatures& features, const Pose& T_map_sensor,
                     const ScanMotion& motion) {
  const auto in_map = [&](const std::vector<FeaturePoint>& points) {
    std::vector<Eigen::Vector3f> result = motion_corrected(points, motion);
    for (Eigen::Vector3f& point_m : result) {
      point_m = (T_map_sensor * point_m.cast<double>()).cast<float>();
    }
    return result;
  };
  const auto insert = [&](const std::vector<FeaturePoint>& points, FeatureMap& map) {
    std::vector<float> intensity;
    for (const FeaturePoint& point : points) intensity.push_back(point.intensity);
    map.insert(in_map(points), keyframes_, intensity);
  };
  insert(features.edges, map_.edges);
  insert(features.posts, map_.posts);
  insert(features.ground, map_.planes);
  insert(features.surfaces, map_.planes);
  if (keyframes_ > 0) path_m_ += distance_m(T_map_sensor, T_map_last_keyframe_);
  T_map_last_keyframe_ = T_map_sensor;
  ++keyframes_;
  recent_path_m_.push_back(path_m_);
  while (recent_path_m_.front() < path_m_ - options_.recent_path_m) recent_path_m_.pop_front();
}

MapPoints Mapping::slide_window() {
  return map_.take_not_observed_since(keyframes_ -
                                      static_cast<std::uint32_t>(recent_path_m_.size()));
}

MapPoints Mapping::clear_window() {
  recent_path_m_.clear();
  return map_.take_all();
}

void Mapping::restore_to_window(MapPoints points) {
  for (auto* kind : {&points.edges, &points.posts, &points.planes}) {
    for (MapPoint& point : *kind) point.last_observed = keyframes_ - 1;
  }
  map_.insert(points);
}

void Mapping::change_options(const MappingOptions& options) {
  options_ = options;
  if (is_given_) return;
  const MapPoints points = map_.take_all();
  map_ = FeatureMaps(options);
  map_.insert(points);
}

void Mapping::correct(const std::vector<Pose>& corrections) {
  map_.correct(corrections);
  T_map_last_keyframe_ = orthonormalized(corrections.back() * T_map_last_keyframe_);
}

}  // namespace hqslam::slam
