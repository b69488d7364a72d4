#pragma once

#include <vector>

#include "hqslam/core/pose.h"
#include "points.h"

namespace hqslam::lego_loam {

/// What mapping takes of a scan, at the end of its sweep.
struct ScanForMap {
  Cloud edges;
  Cloud planes;
  Cloud outliers;
};

/// Section III-E. In: the features of a scan and its pose by odometry. Out: its pose in the map.
///
/// The map is that of the keyframes within 50 m, of which one per cell of 1 m is taken: edges
/// thinned to 0.2 m; planar features and outliers to 0.4 m, as those of the scan. An edge feature
/// belongs to a line where its five nearest edges of the map are within 1 m and the largest
/// eigenvalue of their covariance is above three times the second; a planar one to a plane where
/// its five nearest are within 1 m, and within 0.2 m of a plane through them. Weights are 1 - 0.9
/// d, of planes 1 - 0.9 d / sqrt(range), and below 0.1 left out. Levenberg-Marquardt (Ceres) over
/// all six parameters, up to ten searches. A scan that ends 0.3 m from the last keyframe is the
/// next one.
///
/// Differs from LeGO-LOAM: the paper's map reaches 100 m, its program's 50 m. The program makes
/// one Gauss-Newton step a search, divides a plane's distance by the root of the point's distance
/// from the map's origin instead of the sensor, leaves out directions whose eigenvalue is below
/// 100, and where it takes one of several keyframes in a cell takes the one with their mean number.
class Mapping {
 public:
  /// Registers the scan with the map and, if it moved on, adds it as a keyframe.
  void add(const ScanForMap& scan, const Pose& T_odom_end);

  /// By how much the map corrects odometry.
  Pose T_map_odom() const;
  bool keyframe() const { return keyframe_; }  ///< whether the last scan became one
  int edges() const { return edges_; }         ///< correspondences of the last search; 0: too few
  int planes() const { return planes_; }

  /// All keyframes' planar features, then their edge features, thinned.
  Cloud map() const;

 private:
  struct Keyframe {
    Eigen::Vector3d position_m;
    Cloud edges;   ///< in the map's frame
    Cloud planes;  ///< in the map's frame, with the outliers
  };
  std::vector<const Keyframe*> surrounding() const;
  void match(const Cloud& edges, const Cloud& planes);

  Pose T_odom_end_ = Pose::Identity();  ///< of the last scan that was mapped
  Pose T_map_end_ = Pose::Identity();
  bool keyframe_ = false;
  int edges_ = 0;
  int planes_ = 0;
  std::vector<Keyframe> keyframes_;
};

}  // namespace hqslam::lego_loam
