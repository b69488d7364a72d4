#pragma once

#include <vector>

#include "hqslam/core/pose.h"
#include "points.h"
#include "registration.h"

namespace hqslam::lego_loam {

/// Points of a scan, at the end of its sweep.
struct ScanForMap {
  Cloud edges;
  Cloud planes;
  Cloud outliers;
};

struct MappingResult {
  Pose T_map_odom = Pose::Identity();  ///< by how much the map corrects odometry
  int edges = 0;                       ///< correspondences of the last search; 0: too few
  int planes = 0;
  bool keyframe = false;  ///< the scan was added to the map
};

/// Section III-E. In: the features of a scan and its pose by odometry. Out: its pose in the map.
///
/// The map is that of the keyframes within 50 m, one per cell of 1 m: edges thinned to 0.2 m,
/// planar features and outliers to 0.4 m. An edge feature belongs on the line, a planar one on the
/// plane through its five nearest points of the map, if these are within 1 m and their covariance
/// has one eigenvalue significantly (three times) larger, or smaller, than the other two; points of
/// a plane are at most 0.2 m off it. Distances d are weighted by 1 - 0.9 d, from planes by
/// 1 - 0.9 d / sqrt(range), and those below 0.1 left out. Levenberg-Marquardt over all six
/// parameters, up to ten searches. A scan 0.3 m from the last keyframe becomes the next one.
///
/// Differs from LeGO-LOAM: the paper's map reaches 100 m, its program's 50 m. The program makes one
/// Gauss-Newton step a search; asks no plane for two directions of spread, as LOAM's paper does;
/// divides by the root of the point's distance from the map's origin instead of the sensor; leaves
/// out directions whose eigenvalue is below 100; of several keyframes in a cell takes the one with
/// their mean number; and does not move outliers to the end of the sweep.
class Mapping {
 public:
  /// Registers the scan with the map and, if it moved on, adds it as a keyframe.
  const MappingResult& add(const ScanForMap& scan, const Pose& T_odom_end);

  /// All keyframes' planar features, then their edge features, thinned.
  Cloud map() const;

 private:
  struct Keyframe {
    Eigen::Vector3d position_m;
    Cloud edges;   ///< in the map's frame
    Cloud planes;  ///< in the map's frame, with the outliers
  };
  std::vector<const Keyframe*> surrounding(const Eigen::Vector3d& position_m) const;
  Pose match(const Cloud& edges, const Cloud& planes, const Pose& T_map_end);

  MappingResult result_;
  std::vector<Keyframe> keyframes_;
};

}  // namespace hqslam::lego_loam
