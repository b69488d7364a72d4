#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/pose.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "map/feature_map.h"

namespace hqslam::slam {

/// Largest distance of a feature from its neighbours in the map.
inline constexpr double kMapReach_m = 1.0;
/// Voxel size of edges and posts in the map.
inline constexpr double kMapEdgeLeaf_m = 0.2;

/// Points of the three kinds that a map is made of.
struct MapPoints {
  std::vector<MapPoint> edges;
  std::vector<MapPoint> posts;
  std::vector<MapPoint> planes;
};

/// A map of each of the three kinds of features.
struct FeatureMaps {
  explicit FeatureMaps(const MappingOptions& options);
  FeatureMaps(const MappingOptions& options, const SavedMap& map);

  /// The local map about a place.
  FeatureMaps about(const MappingOptions& options, const Surroundings& place) const;

  void insert(const MapPoints& points);
  MapPoints take_not_observed_since(std::uint32_t keyframe);
  MapPoints take_all();
  MapPoints take_near(const Surroundings& place);
  void correct(const std::vector<Pose>& corrections);

  FeatureMap edges;
  FeatureMap posts;
  FeatureMap planes;
};

void append(MapPoints& points, const MapPoints& others);

/// Moves points with the keyframes that observed them first; in: T_corrected_map of each keyframe.
void correct(MapPoints& points, const std::vector<Pose>& corrections);

}  // namespace hqslam::slam
