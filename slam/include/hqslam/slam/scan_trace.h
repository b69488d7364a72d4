#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/pose.h"

namespace hqslam::slam {

enum class PixelClass : std::uint8_t {
  kNoReturn,
  kGround,
  kCluster,  ///< part of a cluster large enough to be trusted
  kOutlier,  ///< clutter, too small a cluster: leaves, noise
};

enum class FeatureKind : std::uint8_t { kEdge, kPost, kGround, kSurface };
std::string_view name(FeatureKind kind);  ///< "edge", "post", "ground", "surface"

/// A feature of a scan, and what it was matched with in the map.
struct TracedFeature {
  FeatureKind kind = FeatureKind::kEdge;
  /// The pixel nearest to it: a feature can be the mean of several points.
  int row = 0;
  int column = 0;
  Eigen::Vector3f point_m = Eigen::Vector3f::Zero();  ///< level frame, corrected for motion
  bool is_matched = false;
  /// If it was: the foot of the perpendicular on its line or plane, map frame; how far it is from
  /// it at the found pose; and the weight of that, robust and by the noise of its kind. The
  /// residual that is minimised is their product.
  Eigen::Vector3f on_map_m = Eigen::Vector3f::Zero();
  double residual_m = 0.0;
  double weight_per_m = 0.0;
};

/// What SLAM made of one scan, stage by stage, for whoever wants to look at it: Slam::process().
/// The level frame is the sensor's turned upright (Slam::mounting()); all poses are its own. Of a
/// sensor that hangs upside down rows and columns of the cloud are reversed, too.
struct ScanTrace {
  OrganizedCloud cloud;                 ///< as the stages take it: level frame, not corrected
  std::vector<PixelClass> pixel_class;  ///< one per pixel
  std::string_view state_before;        ///< "starting", "tracking", "lost" or "searching"
  std::string_view state;

  Pose T_map_expected = Pose::Identity();  ///< with the velocity of the scan before
  Pose T_map_odometry = Pose::Identity();  ///< the reference's pose, moved by the odometry
  Pose T_map_level = Pose::Identity();     ///< found
  double duration_s = 0.0;                 ///< since the reference

  int sharp_edges = 0;  ///< that the odometry matched with the reference
  int flat_points = 0;
  std::vector<TracedFeature> features;  ///< that were to be matched with the map
  double inlier_ratio = 0.0;            ///< of those that are not ground, in the last wide search
  double last_inlier_ratio = 0.0;       ///< of the last scan that was registered; 0: there is none

  /// Which share of the matches' weight has information about each direction of motion (rising),
  /// and the directions, a column each: x, y, z [m], and 10 m times rotation about x, y, z [rad],
  /// in axes of the map with the sensor as origin: a match d away counts (d / 10 m)^2 times about
  /// the rotations, which can exceed 1. Zero where nothing was matched.
  Eigen::Matrix<double, 6, 1> direction_share = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 6> direction = Eigen::Matrix<double, 6, 6>::Zero();
  int degenerate_directions = 0;  ///< of which too little is known: the first ones
};

}  // namespace hqslam::slam
