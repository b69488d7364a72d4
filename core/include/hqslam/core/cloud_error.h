#pragma once

#include <Eigen/Core>
#include <vector>

namespace hqslam {

/// Errors of a point cloud against the true one. Definitions: TULIP (CVPR 2024), evaluation code.
struct CloudError {
  double chamfer_m2 = 0.0;     ///< mean squared nearest distance cloud->true plus true->cloud
  double iou = 0.0;            ///< occupied voxels of 0.1 m: both / either
  double precision = 0.0;      ///< occupied in both / occupied in cloud
  double recall = 0.0;         ///< occupied in both / occupied in true
  double f1 = 0.0;             ///< harmonic mean of precision and recall
  double outlier_share = 0.0;  ///< points farther than 0.5 m from the nearest true point
};
inline constexpr double kCloudErrorVoxel_m = 0.1;
inline constexpr double kOutlierDistance_m = 0.5;
/// The grid of voxels begins at the lowest corner of both clouds. Throws Error if either cloud is
/// empty or has a coordinate that is not finite.
CloudError cloud_error(const std::vector<Eigen::Vector3f>& cloud_m,
                       const std::vector<Eigen::Vector3f>& true_cloud_m);

/// Occupied voxels of kCloudErrorVoxel_m of two clouds; the grid as in cloud_error. Throws Error as
/// it does.
struct VoxelOverlap {
  double iou = 0.0;
  double precision = 0.0;
  double recall = 0.0;
  double f1 = 0.0;
};
VoxelOverlap voxel_overlap(const std::vector<Eigen::Vector3f>& cloud_m,
                           const std::vector<Eigen::Vector3f>& true_cloud_m);

/// The distance of each point of the cloud to the nearest true point, metres. Throws Error as
/// cloud_error does.
std::vector<float> nearest_distances_m(const std::vector<Eigen::Vector3f>& cloud_m,
                                       const std::vector<Eigen::Vector3f>& true_cloud_m);

}  // namespace hqslam
