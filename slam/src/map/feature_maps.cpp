#include "map/feature_maps.h"

#include <array>
#include <limits>

namespace hqslam::slam {

namespace {

/// One of the kinds of features, on its own and in a map.
struct Kind {
  std::vector<MapPoint> MapPoints::*points;
  FeatureMap FeatureMaps::*map;
};
/// Kinds with most points first, so that the longest work begins first.
constexpr std::array<Kind, 3> kKinds = {{{&MapPoints::planes, &FeatureMaps::planes},
                                         {&MapPoints::posts, &FeatureMaps::posts},
                                         {&MapPoints::edges, &FeatureMaps::edges}}};

}  // namespace

FeatureMaps::FeatureMaps(const MappingOptions& options)
    : edges(kMapEdgeLeaf_m, kMapReach_m),
      posts(kMapEdgeLeaf_m, kMapReach_m),
      planes(options.planar_leaf_m, kMapReach_m) {}

FeatureMaps::FeatureMaps(const MappingOptions& options, const SavedMap& map)
    : FeatureMaps(options) {
  edges.insert(map.edges_m, 0, map.edges_intensity);
  posts.insert(map.posts_m, 0, map.posts_intensity);
  planes.insert(map.planes_m, 0, map.planes_intensity);
}

FeatureMaps FeatureMaps::about(const MappingOptions& options, const Surroundings& place) const {
  FeatureMaps result(options);
  for (const Kind& kind : kKinds) {
    (result.*kind.map).insert((this->*kind.map).points_near_m(place));
  }
  return result;
}

void FeatureMaps::insert(const MapPoints& points) {
#pragma omp parallel for schedule(dynamic, 1)
  for (const Kind& kind : kKinds) (this->*kind.map).insert(points.*kind.points);
}

MapPoints FeatureMaps::take_not_observed_since(std::uint32_t keyframe) {
  MapPoints result;
  for (const Kind& kind : kKinds) {
    result.*kind.points = (this->*kind.map).take_not_observed_since(keyframe);
  }
  return result;
}

MapPoints FeatureMaps::take_all() {
  return take_not_observed_since(std::numeric_limits<std::uint32_t>::max());
}

MapPoints FeatureMaps::take_near(const Surroundings& place) {
  MapPoints result;
  for (const Kind& kind : kKinds) result.*kind.points = (this->*kind.map).take_near(place);
  return result;
}

void FeatureMaps::correct(const std::vector<Pose>& corrections) {
#pragma omp parallel for schedule(dynamic, 1)
  for (const Kind& kind : kKinds) (this->*kind.map).correct(corrections);
}

void append(MapPoints& points, const MapPoints& others) {
  for (const Kind& kind : kKinds) {
    std::vector<MapPoint>& of_kind = points.*kind.points;
    of_kind.insert(of_kind.end(), (others.*kind.points).begin(), (others.*kind.points).end());
  }
}

void correct(MapPoints& points, const std::vector<Pose>& corrections) {
  for (const Kind& kind : kKinds) {
    for (MapPoint& point : points.*kind.points) {
      const Pose& correction = corrections[point.keyframe];
      if (correction.matrix().isIdentity(0.0)) continue;
      point.mean_m = (correction * point.mean_m.cast<double>()).cast<float>();
    }
  }
}

}  // namespace hqslam::slam
