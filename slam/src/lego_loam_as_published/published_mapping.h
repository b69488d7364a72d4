#pragma once

#include <vector>

#include "published_odometry.h"

namespace hqslam::slam::as_published {

/// LeGO-LOAM's map optimisation without loop closing, whose pose graph then changes nothing.
///
/// The map: of the keyframes within 50 m of the last pose, thinned to one per metre by averaging
/// positions and numbers alike, the edges (0.2 m) and the surfaces with the outliers (0.4 m). Up to
/// 10 full Gauss-Newton steps over all six parameters; an edge is matched with the line through its
/// five nearest, a planar point with the plane through its five nearest, weighed by
/// 1 - 0.9 d / sqrt(|p|) with p in the map's frame: the farther from where the drive began, the
/// less distance counts. A keyframe every 0.3 m; turning makes none.
class PublishedMapping {
 public:
  /// T_odom_end: the odometry's pose. outliers: sensor frame, not corrected for motion.
  void add(const LastScan& scan, const std::vector<FeaturePoint>& outliers, const Pose& T_odom_end);

  /// What takes poses of the odometry into the map.
  Pose T_map_odom() const { return T_map_end_ * T_odom_end_.inverse(); }

 private:
  struct Keyframe {
    Pose T_map_end = Pose::Identity();
    std::vector<Eigen::Vector3f> edges_m;
    std::vector<Eigen::Vector3f> surfaces_m;  ///< with the outliers
  };
  std::vector<std::size_t> surrounding_keyframes() const;
  void match(const std::vector<Eigen::Vector3f>& edges_m,
             const std::vector<Eigen::Vector3f>& surfaces_m);

  std::vector<Keyframe> keyframes_;
  Pose T_odom_end_ = Pose::Identity();  ///< of the last scan that was matched
  Pose T_map_end_ = Pose::Identity();
};

}  // namespace hqslam::slam::as_published
