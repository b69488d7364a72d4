#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "hqslam/core/pose.h"
#include "map/mapping.h"

namespace hqslam::slam {

/// What the sensor saw over the last metres of the path: a denser picture of the place than one
/// scan gives, above all with few rows, and harder to mistake for another place.
class RecentFeatures {
 public:
  explicit RecentFeatures(std::size_t max_scans) : max_scans_(max_scans) {}

  /// Keeps the features of a scan and forgets those of the oldest beyond max_scans.
  void add(const MapFeatures& features, const Pose& T_map_sensor, const Twist& velocity);

  /// The map was corrected: so are the poses of the scans, which all moved with the last of them.
  void correct(const Pose& T_corrected_map);

  /// All features within 35 m of the last scan's sensor, in its frame, thinned, at most 800 of each
  /// kind. Edges and what is for registration are filled.
  MapFeatures about_last() const;

 private:
  struct Scan {
    Pose T_map_sensor;
    std::vector<Eigen::Vector3f> edges_m;
    std::vector<Eigen::Vector3f> ground_m;
    std::vector<Eigen::Vector3f> surfaces_m;
  };
  std::vector<FeaturePoint> gathered(std::vector<Eigen::Vector3f> Scan::*kind, double leaf_m) const;

  std::size_t max_scans_;
  std::deque<Scan> scans_;
};

}  // namespace hqslam::slam
