#include "map/map_constraints.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "alignment/robust_weights.h"
#include "front_end/motion_correction.h"

namespace hqslam::slam {

namespace {

constexpr double kMinMapWeight = 0.1;  // as in LeGO-LOAM
/// Cosine of the steepest ground's angle with the sensor's: 12 degrees and less do not help
/// (simulated drives alone).
constexpr double kMinGroundUprightness = 0.9;
constexpr double kMinSine = 0.5;  // of the angle between two directions that make a plane

std::optional<EdgeConstraints> match_edge(const std::optional<MapLine>& line,
                                          const Eigen::Vector3d& rotated_m,
                                          const Eigen::Vector3d& origin_m) {
  if (!line) return std::nullopt;
  const Eigen::Vector3d on_line_m = line->point_m - origin_m;
  const double distance_m = line->direction.cross(rotated_m - on_line_m).norm();
  const double weight = 1.0 - 0.9 * distance_m;
  if (weight < kMinMapWeight) return std::nullopt;
  return edge_constraints(rotated_m, on_line_m, line->direction, weight);
}

/// The plane of a surface from a line on it and another direction.
std::optional<MapPlane> plane_through(const MapLine& line, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d normal = line.direction.cross(direction);
  if (!(normal.norm() > kMinSine)) return std::nullopt;
  return MapPlane{line.point_m, normal.normalized(), line.tilt * line.direction};
}

/// The plane of a surface, or the one through its line and `direction`.
std::optional<MapPlane> completed(const std::optional<MapSurface>& surface,
                                  const Eigen::Vector3d& direction) {
  if (!surface) return std::nullopt;
  if (const auto* plane = std::get_if<MapPlane>(&*surface)) return *plane;
  return plane_through(std::get<MapLine>(*surface), direction);
}

std::optional<PlaneConstraint> match_surface(const std::optional<MapPlane>& plane,
                                             const Eigen::Vector3d& rotated_m,
                                             const Eigen::Vector3d& origin_m) {
  if (!plane) return std::nullopt;
  const double offset_m = plane->normal.dot(plane->point_m - origin_m);
  const double distance_m = std::abs(plane->normal.dot(rotated_m) - offset_m);
  const double weight = 1.0 - 0.9 * distance_m / std::sqrt(rotated_m.norm());
  if (weight < kMinMapWeight) return std::nullopt;
  return PlaneConstraint{rotated_m, plane->normal, offset_m, weight, plane->tilt};
}

/// Reduces a ground plane to its information about height, roll and pitch.
///
/// A scan's ring on the ground is beside the rings of earlier scans in the map. The slope of a
/// plane through points of two rings a few decimetres apart is mostly noise, and the horizontal
/// component of its normal pulls the ring towards those of the map, against the motion. So the
/// normal n is replaced by its component along the vertical u of the ground, n' = (n . u) u; the
/// distance of the point remains.
std::optional<PlaneConstraint> upright(std::optional<PlaneConstraint> ground,
                                       const Eigen::Vector3d& vertical) {
  if (!ground) return std::nullopt;
  const double distance_m = ground->normal.dot(ground->point_m) - ground->offset_m;
  const double share = ground->normal.dot(vertical);
  if (std::abs(share) < kMinGroundUprightness) return std::nullopt;
  ground->normal = share * vertical;
  ground->tilt = ground->tilt.dot(vertical) * vertical;
  ground->offset_m = ground->normal.dot(ground->point_m) - distance_m;
  return ground;
}

/// Reduces a surface's plane to its information about x, y, yaw and, by its lever, roll and pitch.
///
/// Most surfaces are upright. On others (kerbs, cars, leaves, undetected ground) five points of
/// distant rows make a random slope, and such slopes, all observed from the same side, tilt the map
/// scan by scan. So the normal n loses its component along the vertical u of the ground,
/// n' = n - (n . u) u; the distance of the point remains. Height comes from the ground alone.
std::optional<PlaneConstraint> horizontal(std::optional<PlaneConstraint> surface,
                                          const Eigen::Vector3d& vertical) {
  if (!surface) return std::nullopt;
  const double distance_m = surface->normal.dot(surface->point_m) - surface->offset_m;
  surface->normal -= surface->normal.dot(vertical) * vertical;
  surface->tilt -= surface->tilt.dot(vertical) * vertical;
  surface->offset_m = surface->normal.dot(surface->point_m) - distance_m;
  return surface;
}

void put_time(float time_offset_s, PlaneConstraint& plane) { plane.time_offset_s = time_offset_s; }
void put_time(float time_offset_s, EdgeConstraints& edge) {
  for (PlaneConstraint& plane : edge) plane.time_offset_s = time_offset_s;
}

/// One constraint or none per feature, searched in parallel: constrain(i, fit, rotated_m).
template <typename Fit, int kNeighbours, typename Make, typename Constrain>
auto find_all(SearchedFeatures<Fit, kNeighbours>& searched, const MapSearch& search,
              const FeatureMap& map, const Make& make, const Constrain& constrain) {
  const MotionCorrection corrected(search.motion);
  const Eigen::Matrix3d rotation = search.T_map_sensor.linear();
  const Eigen::Vector3d origin_m = search.T_map_sensor.translation();
  std::vector<decltype(constrain(std::size_t(), std::optional<Fit>(), Eigen::Vector3d()))> found(
      searched.features.size());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::Vector3f point_m = corrected(searched.features[i]);
    const Eigen::Vector3d rotated_m = rotation * point_m.cast<double>();
    const Eigen::Vector3f query_m = (rotated_m + origin_m).cast<float>();
    found[i] = constrain(i, searched.nearby[i].at(map, query_m, search.reach_m, make), rotated_m);
    if (found[i]) put_time(searched.features[i].time_offset_s, *found[i]);
  }
  return found;
}

/// Constraints of the ground. A line (points of one row) is completed by the slope that the scan
/// measured there. Such planes are made of chords between rows that may be metres apart, so they
/// count only while they are the majority, in a map of few scans. There they prevent a tilt of
/// sensor and map by tenths of a degree at the start.
std::vector<std::optional<PlaneConstraint>> ground_constraints(SearchedFeatures<MapSurface>& ground,
                                                               const Eigen::Vector3d& vertical,
                                                               const MapSearch& search,
                                                               const FeatureMap& planes,
                                                               const MappingOptions& options) {
  const Eigen::Vector3d origin_m = search.T_map_sensor.translation();
  const Eigen::Matrix3d rotation = search.T_map_sensor.linear();
  std::vector<std::uint8_t> by_line(ground.features.size(), 0);
  auto found = find_all(
      ground, search, planes,
      [&](const Neighbours& near) { return fit_surface(near, options.max_ground_residual_m); },
      [&](std::size_t i, const std::optional<MapSurface>& near, const Eigen::Vector3d& rotated_m) {
        by_line[i] = near && std::holds_alternative<MapLine>(*near) ? 1 : 0;
        const Eigen::Vector3d slope = rotation * ground.features[i].slope.cast<double>();
        return upright(match_surface(completed(near, slope), rotated_m, origin_m), vertical);
      });
  int by_plane = 0;
  int by_lines = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i]) ++(by_line[i] != 0 ? by_lines : by_plane);
  }
  for (std::size_t i = 0; i < found.size() && by_plane > by_lines; ++i) {
    if (by_line[i] != 0) found[i].reset();
  }
  return found;
}

/// Constraints of surfaces. A line (points of one row) is completed by the slope that the scan
/// measured there, mostly to the most upright plane through it. On a ceiling that plane would hold
/// the sensor by the ceiling's rings, which travel with it.
std::vector<std::optional<PlaneConstraint>> surface_constraints(
    SearchedFeatures<MapSurface>& surfaces, const Eigen::Vector3d& vertical,
    const MapSearch& search, const FeatureMap& planes, const MappingOptions& options,
    bool ground_has_height) {
  const Eigen::Vector3d origin_m = search.T_map_sensor.translation();
  const Eigen::Matrix3d rotation = search.T_map_sensor.linear();
  return find_all(
      surfaces, search, planes,
      [&](const Neighbours& near) { return fit_surface(near, options.max_plane_residual_m); },
      [&](std::size_t i, const std::optional<MapSurface>& near, const Eigen::Vector3d& rotated_m) {
        const Eigen::Vector3d slope = rotation * surfaces.features[i].slope.cast<double>();
        const auto constraint = match_surface(completed(near, slope), rotated_m, origin_m);
        return ground_has_height ? horizontal(constraint, vertical) : constraint;
      });
}

std::vector<std::optional<EdgeConstraints>> edge_constraints_of(SearchedFeatures<MapLine>& edges,
                                                                const MapSearch& search,
                                                                const FeatureMap& map) {
  const Eigen::Vector3d origin_m = search.T_map_sensor.translation();
  return find_all(
      edges, search, map, fit_line,
      [&](std::size_t, const std::optional<MapLine>& line, const Eigen::Vector3d& rotated_m) {
        return match_edge(line, rotated_m, origin_m);
      });
}

/// Constraints of posts. A row has one point of each, which has no information about height: it
/// belongs on the upright line through the nearest post of the map.
std::vector<std::optional<EdgeConstraints>> post_constraints(
    SearchedFeatures<Eigen::Vector3d, 1>& posts, const Eigen::Vector3d& vertical,
    const MapSearch& search, const FeatureMap& map) {
  const Eigen::Vector3d origin_m = search.T_map_sensor.translation();
  return find_all(
      posts, search, map,
      [](const Neighbours& near) {
        return std::optional<Eigen::Vector3d>(near.points_m[0].cast<double>());
      },
      [&](std::size_t, const std::optional<Eigen::Vector3d>& post_m,
          const Eigen::Vector3d& rotated_m) -> std::optional<EdgeConstraints> {
        if (!post_m) return std::nullopt;
        return edge_constraints(rotated_m, *post_m - origin_m, vertical, 1.0);
      });
}

}  // namespace

ConstraintList MapMatches::constraints() const {
  ConstraintList list;
  list.all.reserve(ground.size() + surfaces.size() + 2 * (edges.size() + posts.size()));
  list.add(ground);
  list.ground = list.planes;
  list.add(surfaces);
  list.add(edges);
  list.add(posts);
  return list;
}

MapMatches match_with_map(RegisteredScan& scan, const MapSearch& search, const FeatureMaps& map,
                          const MappingOptions& options) {
  const auto weighed = [&](auto found) {
    weigh_by_noise(found, options.trusted_residual_m, search.trust_near);
    return found;
  };
  const auto count = [](const auto& found) {
    return std::ranges::count_if(found, [](const auto& match) { return match.has_value(); });
  };
  const Eigen::Vector3d vertical = search.T_map_sensor.linear() * scan.up;
  MapMatches result;
  result.ground = ground_constraints(scan.ground, vertical, search, map.planes, options);
  if (count(result.ground) < kMinGroundConstraints && search.ground_reach_m > search.reach_m) {
    MapSearch wider = search;
    wider.reach_m = search.ground_reach_m;
    result.ground = ground_constraints(scan.ground, vertical, wider, map.planes, options);
  }
  result.ground = weighed(std::move(result.ground));
  const auto by_ground = count(result.ground);
  result.surfaces = weighed(surface_constraints(scan.surfaces, vertical, search, map.planes,
                                                options, by_ground >= kMinGroundConstraints));
  result.edges = weighed(edge_constraints_of(scan.edges, search, map.edges));
  result.posts = weighed(post_constraints(scan.posts, vertical, search, map.posts));
  return result;
}

}  // namespace hqslam::slam
