#pragma once

#include <Eigen/Core>
#include <vector>

namespace hqslam {

/// Overlap of the voxels, kCloudErrorVoxel_m wide, that two clouds occupy. Source of all
/// definitions in this header: evaluation code of TULIP (CVPR 2024).
struct VoxelOverlap {
  double iou = 0.0;        ///< occupied in both / in either
  double precision = 0.0;  ///< occupied in both / occupied in cloud
  double recall = 0.0;     ///< occupied in both / occupied in true
  double f1 = 0.0;         ///< harmonic mean of precision and recall
};
inline constexpr double kCloudErrorVoxel_m = 0.1;
/// The grid begins at the lowest corner of both clouds. Throws Error if either cloud is empty or
/// has a coordinate that is not finite.
VoxelOverlap voxel_overlap(const std::vector<Eigen::Vector3f>& cloud_m,
                           const std::vector<Eigen::Vector3f>& true_cloud_m);

/// Errors of a point cloud against the true one.
struct CloudError : VoxelOverlap {
  double chamfer_m2 = 0.0;     ///< mean squared nearest distance cloud->true plus true->cloud
  double outlier_share = 0.0;  ///< points farther than 0.5 m from the nearest true point
};
inline constexpr double kOutlierDistance_m = 0.5;
/// Throws Error as voxel_overlap does.
CloudError cloud_error(const std::vector<Eigen::Vector3f>& cloud_m,
                       const std::vector<Eigen::Vector3f>& true_cloud_m);
/// Sum and quotient, figure by figure, for means over clouds.
CloudError& operator+=(CloudError& sum, const CloudError& error);
CloudError& operator/=(CloudError& sum, double clouds);

/// The distance of each point of the cloud to the nearest true point, metres. Throws Error as
/// cloud_error does.
std::vector<float> nearest_distances_m(const std::vector<Eigen::Vector3f>& cloud_m,
                                       const std::vector<Eigen::Vector3f>& true_cloud_m);

}  // namespace hqslam
