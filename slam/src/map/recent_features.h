#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "hqslam/core/pose.h"
#include "map/mapping.h"

namespace hqslam::slam {

/// The features of the last scans together: a denser picture of the place than one scan, above all
/// with few rows, and less ambiguous.
class RecentFeatures {
 public:
  explicit RecentFeatures(std::size_t max_scans) : max_scans_(max_scans) {}

  /// Adds the features of a scan and drops those of the oldest beyond max_scans.
  void add(const MapFeatures& features, const Pose& T_map_sensor, const ScanMotion& motion);

  /// Applies a correction of the map, that of the last keyframe, to the poses of the scans.
  void correct(const Pose& T_corrected_map);

  /// All features within 35 m of the last scan's sensor, in its frame, thinned, at most 800 of each
  /// kind: edges, ground_to_register and surfaces_to_register.
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
