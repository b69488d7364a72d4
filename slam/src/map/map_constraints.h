#pragma once

#include <vector>
#include <array>

#include "alignment/rigid_alignment.h"
#include "hqslam/slam/mapping.h"
#include "map/map_matching.h"
#include "map/nearby_fit.h"

namespace hqslam::slam {

/// A kind of features with what is near each of them in the map.
template <typename Fit, int kNeighbours = Neighbours::kWanted>
struct SearchedFeatures {
  const std::vector<FeaturePoint>& features;
  std::vector<NearbyFit<Fit, kNeighbours>> nearby;

  explicit SearchedFeatures(const std::vector<FeaturePoint>& searched)
      : features(searched), nearby(searched.size()) {}
};

struct Shaped {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  std::optional<MapSurface> surface;
  std::array<Eigen::Vector3f, 5> points_m;
};

/// The features of a scan while it is located.
struct LocatedScan {
  SearchedFeatures<MapSurface> ground;
  SearchedFeatures<MapSurface> surfaces;
  SearchedFeatures<MapLine> edges;
  SearchedFeatures<Eigen::Vector3d, 1> posts;  ///< with the nearest post of the map
  SearchedFeatures<Shaped> shaped_ground;
  SearchedFeatures<Shaped> shaped_surfaces;
};

/// Where a scan is believed to be, and how far about its features the map is searched: five
/// neighbours that are farther apart are seldom of one surface.
struct MapSearch {
  Pose T_map_sensor;
  Twist velocity;  ///< a second
  double reach_m;
  bool trust_near;  ///< take weight from features far from their line or plane
};

/// What the map says about where a scan is: per feature that finds its line or plane, constraints
/// of the motion that remains, in axes of the map with search.T_map_sensor's position as origin
/// (points are R p, planes are moved by -t). Features are searched in parallel.
ConstraintList map_constraints(LocatedScan& scan, const MapSearch& search, const FeatureMaps& map,
                               const MappingOptions& options, bool height_told = false);

}  // namespace hqslam::slam
