#include <algorithm>

#include "foreign_map/surfels.h"
#include "foreign_map/viewpoints.h"
#include "foreign_map/virtual_scan.h"
#include "front_end/features.h"
#include "front_end/segmentation.h"
#include "hqslam/core/error.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "map/feature_maps.h"
#include "map/mapping.h"
#include "thread_limit.h"

namespace hqslam::slam {

namespace {

/// At this distance from the origin a float still tells centimetres apart.
constexpr float kFarthestPoint_m = 1e5F;
constexpr double kFine_m = 0.1;
constexpr double kCoarse_m = 0.3;
constexpr std::size_t kFewestSurfels = 1000;
constexpr std::size_t kMostPlaces = 20'000;
/// Edges farther from a place are seen from a nearer one.
constexpr float kEdgesWithin_m = 30.0F;
/// Places whose features are in memory at once.
constexpr std::size_t kAtOnce = 64;

std::vector<Surfel> checked_surfels(const std::vector<Eigen::Vector3f>& points_m) {
  for (const Eigen::Vector3f& point_m : points_m) {
    if (point_m.allFinite() && point_m.cwiseAbs().maxCoeff() <= kFarthestPoint_m) continue;
    throw Error(
        "expected a cloud within {:.0f} km of its origin, in metres, found a point at {} {} {}; "
        "shift it",
        kFarthestPoint_m / 1000.0F, point_m.x(), point_m.y(), point_m.z());
  }
  std::vector<Surfel> surfels = surfels_of(points_m, kFine_m);
  if (surfels.size() < kFewestSurfels) {
    throw Error(
        "expected a cloud with at least {} places of 0.1 m that have neighbours within 0.5 m, "
        "found "
        "{} among {} points; give a denser one, in metres",
        kFewestSurfels, surfels.size(), points_m.size());
  }
  return surfels;
}

std::vector<Pose> checked_viewpoints(const std::vector<Surfel>& surfels) {
  std::vector<Pose> result = viewpoints_in(surfels);
  if (result.empty()) {
    throw Error(
        "expected ground to stand on, 50 m2 and more without steps, found none; the cloud must be "
        "in "
        "metres, with z up");
  }
  if (result.size() > kMostPlaces) {
    throw Error("expected at most {} places to stand at, 4 m apart, found {}; cut the cloud",
                kMostPlaces, result.size());
  }
  return result;
}

std::vector<Eigen::Vector3f> points_on_planes_m(const std::vector<Surfel>& surfels) {
  std::vector<Eigen::Vector3f> result;
  for (const Surfel& surfel : surfels) {
    if (!surfel.normal.isZero()) result.push_back(surfel.point_m);
  }
  return result;
}

struct View {
  MapFeatures features;
  ScanContext context;
};

View view_of(const OrganizedCloud& cloud, const SensorModel& seen_by, const SensorModel& sensor,
             const SlamOptions& options) {
  Segmenter segmenter(seen_by, options.ground, options.segmentation);
  const Features features = extract_features(cloud, segmenter.segment(cloud), options.features);
  return {map_features(features, options.mapping),
          scan_context(with_rows_of(sensor, cloud, seen_by))};
}

std::vector<Eigen::Vector3f> near_in_map(const std::vector<FeaturePoint>& features,
                                         const Pose& T_map_sensor) {
  std::vector<Eigen::Vector3f> result;
  for (const FeaturePoint& feature : features) {
    if (feature.point_m.norm() > kEdgesWithin_m) continue;
    result.push_back((T_map_sensor * feature.point_m.cast<double>()).cast<float>());
  }
  return result;
}

}  // namespace

SavedMap map_of_cloud(const std::vector<Eigen::Vector3f>& points_m, const SensorModel& sensor,
                      const SlamOptions& options) {
  validate(options);
  hqslam::validate(sensor);
  if (sensor.rows() < 2) {
    throw Error(
        "expected a sensor with two rows or more to be located in a cloud, found '{}' with {}; "
        "locate it in a map that it saved",
        sensor.name, sensor.rows());
  }
  const ThreadLimit limit(options.threads);
  const std::vector<Surfel> surfels = checked_surfels(points_m);
  const std::vector<Pose> places = checked_viewpoints(surfels);
  FeatureMaps maps(options.mapping);
  maps.planes.insert(points_on_planes_m(surfels));
  const SurfelTiles fine(surfels);
  const SurfelTiles coarse(surfels_of(points_m, kCoarse_m));
  const SensorModel seen_by = virtual_sensor(sensor);
  const VirtualScanner scanner(seen_by, fine, coarse);
  SavedMap result;
  for (std::size_t first = 0; first < places.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, places.size() - first);
    std::vector<View> views(count);
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t i = 0; i < count; ++i) {
      views[i] = view_of(scanner.scan(places[first + i]), seen_by, sensor, options);
    }
    for (std::size_t i = 0; i < count; ++i) {
      const Pose& T_map_sensor = places[first + i];
      maps.edges.insert(near_in_map(views[i].features.edges, T_map_sensor));
      maps.posts.insert(near_in_map(views[i].features.posts, T_map_sensor));
      result.places.push_back({T_map_sensor, views[i].context});
    }
  }
  result.edges_m = maps.edges.points_m();
  result.posts_m = maps.posts.points_m();
  result.planes_m = maps.planes.points_m();
  return result;
}

}  // namespace hqslam::slam
