#include "points.h"

#include <pcl/common/common.h>
#include <pcl/filters/voxel_grid.h>

namespace hqslam::lego_loam {

Cloud moved(const Pose& T, const Cloud& cloud) {
  Cloud result;
  result.reserve(cloud.size());
  for (const Point& point : cloud) result.push_back(moved(T, point));
  return result;
}

Cloud thinned(const Cloud& cloud, float leaf_m) {
  if (cloud.empty()) return {};
  constexpr float kMaxVoxels = 1 << 30;  // VoxelGrid numbers them with an int
  Eigen::Vector4f low_m;
  Eigen::Vector4f high_m;
  pcl::getMinMax3D(cloud, low_m, high_m);
  const Eigen::Array3f side_m = (high_m - low_m).head<3>();
  if ((side_m / leaf_m + 2.0F).prod() > kMaxVoxels) {
    Eigen::Index axis = 0;
    side_m.maxCoeff(&axis);
    const float middle_m = leaf_m * std::round((low_m[axis] + 0.5F * side_m[axis]) / leaf_m);
    Cloud halves[2];
    for (const Point& point : cloud) halves[point.data[axis] < middle_m ? 0 : 1].push_back(point);
    return thinned(halves[0], leaf_m) + thinned(halves[1], leaf_m);
  }
  pcl::VoxelGrid<Point> grid;
  grid.setLeafSize(leaf_m, leaf_m, leaf_m);
  grid.setInputCloud(cloud.makeShared());
  Cloud result;
  grid.filter(result);
  return result;
}

}  // namespace hqslam::lego_loam
