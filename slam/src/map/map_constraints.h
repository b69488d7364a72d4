#pragma once

#include <optional>
#include <vector>

#include "alignment/rigid_alignment.h"
#include "front_end/features.h"
#include "map/feature_maps.h"
#include "map/map_matching.h"
#include "map/nearby_fit.h"

namespace hqslam::slam {

/// Points of the ground from which on it determines height, roll and pitch, and surfaces do not
/// contribute to the height. Chosen on simulated alleys alone.
inline constexpr int kMinGroundConstraints = 25;

/// The features of a kind with the fits to their neighbours in the map.
template <typename Fit, int kNeighbours = Neighbours::kWanted>
struct SearchedFeatures {
  const std::vector<FeaturePoint>& features;
  std::vector<NearbyFit<Fit, kNeighbours>> nearby;

  explicit SearchedFeatures(const std::vector<FeaturePoint>& searched)
      : features(searched), nearby(searched.size()) {}
};

/// The features of a scan while it is registered.
struct RegisteredScan {
  SearchedFeatures<MapSurface> ground;
  SearchedFeatures<MapSurface> surfaces;
  SearchedFeatures<MapLine> edges;
  SearchedFeatures<Eigen::Vector3d, 1> posts;  ///< with the nearest post of the map
  Eigen::Vector3d up;                          ///< Segmentation::up
};

/// The estimated pose of a scan, and the radius within which the map is searched about its
/// features: five neighbours farther apart are seldom of one surface.
struct MapSearch {
  Pose T_map_sensor;
  ScanMotion motion;
  double reach_m;
  double ground_reach_m;  ///< for the ground, if too little of it is within reach_m
  bool trust_near;        ///< features far from their line or plane lose weight
};

/// The match of each feature of a scan: constraints of the remaining motion, in axes of the map
/// with the position of search.T_map_sensor as origin (points are R p, planes are moved by -t);
/// nothing where a feature finds no line or plane.
struct MapMatches {
  std::vector<std::optional<PlaneConstraint>> ground;
  std::vector<std::optional<PlaneConstraint>> surfaces;
  std::vector<std::optional<EdgeConstraints>> edges;
  std::vector<std::optional<EdgeConstraints>> posts;

  ConstraintList constraints() const;
};

/// Features are searched in parallel.
MapMatches match_with_map(RegisteredScan& scan, const MapSearch& search, const FeatureMaps& map,
                          const MappingOptions& options);

}  // namespace hqslam::slam
