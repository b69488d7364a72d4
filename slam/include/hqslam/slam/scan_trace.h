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
  kObject,  ///< all that is not ground
};

enum class FeatureKind : std::uint8_t { kEdge, kPost, kGround, kSurface };
constexpr std::string_view name(FeatureKind kind) {
  constexpr std::string_view kNames[] = {"edge", "post", "ground", "surface"};
  return kNames[static_cast<int>(kind)];
}

/// A feature of a scan and its match in the map.
struct TracedFeature {
  FeatureKind kind = FeatureKind::kEdge;
  /// The nearest pixel: a feature can be the mean of several points.
  int row = 0;
  int column = 0;
  Eigen::Vector3f point_m = Eigen::Vector3f::Zero();  ///< level frame, corrected for motion
  bool is_matched = false;
  /// If matched: the foot of the perpendicular on its line or plane, map frame; the distance from
  /// that at the found pose; and its weight, robust and by the noise of its kind. The minimised
  /// residual is the product of the two.
  Eigen::Vector3f on_map_m = Eigen::Vector3f::Zero();
  double residual_m = 0.0;
  double weight_per_m = 0.0;
};

/// The results of all stages for one scan (Slam::process()). The level frame is the sensor's turned
/// upright (Slam::mounting()); all poses are of it. If the sensor hangs upside down, rows and
/// columns of the cloud are reversed, too.
struct ScanTrace {
  OrganizedCloud cloud;                 ///< input of the stages: level frame, not motion-corrected
  std::vector<PixelClass> pixel_class;  ///< one per pixel
  std::string_view state_before;        ///< "starting", "tracking", "lost" or "searching"
  std::string_view state;

  Pose T_map_expected = Pose::Identity();  ///< predicted
  Pose T_map_odometry = Pose::Identity();  ///< the reference's pose, moved by the odometry
  Pose T_map_level = Pose::Identity();     ///< the result
  double duration_s = 0.0;                 ///< since the reference

  int sharp_edges = 0;                  ///< matched by the odometry with the reference
  int flat_points = 0;                  ///< matched by the odometry with the reference
  std::vector<TracedFeature> features;  ///< to be matched with the map
  double inlier_ratio = 0.0;            ///< of those that are not ground, in the last wide search
  double last_inlier_ratio = 0.0;       ///< of the last registered scan; 0: none

  /// The share of the matches' weight with information about each direction of motion (rising), and
  /// the directions, a column each: x, y, z [m], and 10 m times rotation about x, y, z [rad], in
  /// axes of the map with the sensor as origin. A match at a distance d counts (d / 10 m)^2 times
  /// for rotations, which can exceed 1. Zero without matches.
  Eigen::Matrix<double, 6, 1, Eigen::DontAlign> direction_share = Eigen::VectorXd::Zero(6);
  Eigen::Matrix<double, 6, 6, Eigen::DontAlign> direction = Eigen::MatrixXd::Zero(6, 6);
  int degenerate_directions = 0;  ///< number of the first directions that are not observable
};

}  // namespace hqslam::slam
