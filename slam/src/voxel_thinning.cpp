#include "voxel_thinning.h"

#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>

namespace hqslam::slam {

std::vector<FeaturePoint> thin(const std::vector<FeaturePoint>& points, double leaf_m) {
  std::vector<FeaturePoint> result;
  if (points.empty()) return result;
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZI>>();
  cloud->reserve(points.size());
  for (const FeaturePoint& point : points) {
    pcl::PointXYZI pcl_point;
    pcl_point.getVector3fMap() = point.point_m;
    pcl_point.intensity = point.time_offset_s;  // averaged like the position
    cloud->push_back(pcl_point);
  }
  pcl::VoxelGrid<pcl::PointXYZI> grid;
  const auto leaf = static_cast<float>(leaf_m);
  grid.setLeafSize(leaf, leaf, leaf);
  grid.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZI> kept;
  grid.filter(kept);
  result.reserve(kept.size());
  for (const pcl::PointXYZI& point : kept) {
    result.push_back({point.getVector3fMap(), point.intensity, points.front().row});
  }
  return result;
}

}  // namespace hqslam::slam
