#include "points.h"

#include <pcl/common/common.h>
#include <pcl/filters/voxel_grid.h>

namespace hqslam::lego_loam {

Cloud thinned(const Cloud& cloud, float leaf_m) {
  Cloud result;
  if (cloud.empty()) return result;
  constexpr float kMaxVoxels = 1 << 30;  // VoxelGrid numbers them with an int
  Point low;
  Point high;
  pcl::getMinMax3D(cloud, low, high);
  const Eigen::Array3f side_m = high.getArray3fMap() - low.getArray3fMap();
  if ((side_m / leaf_m + 2.0F).prod() > kMaxVoxels) {
    Eigen::Index axis = 0;
    side_m.maxCoeff(&axis);
    const float middle_m = leaf_m * std::round((low.data[axis] + 0.5F * side_m[axis]) / leaf_m);
    Cloud halves[2];
    for (const Point& point : cloud) halves[point.data[axis] < middle_m ? 0 : 1].push_back(point);
    return thinned(halves[0], leaf_m) + thinned(halves[1], leaf_m);
  }
  pcl::VoxelGrid<Point> grid;
  grid.setLeafSize(leaf_m, leaf_m, leaf_m);
  grid.setInputCloud(cloud.makeShared());
  grid.filter(result);
  return result;
}

SearchCloud::SearchCloud(const Cloud& points) : cloud(points.makeShared()) {
  if (!cloud->empty()) tree.setInputCloud(cloud);
}

std::vector<int> SearchCloud::nearest(const Point& p, int k, float reach_m) const {
  std::vector<int> index;
  std::vector<float> distance_m2;
  if (cloud->empty() || tree.nearestKSearch(p, k, index, distance_m2) < k) return {};
  return distance_m2.back() < reach_m * reach_m ? index : std::vector<int>();
}

}  // namespace hqslam::lego_loam
