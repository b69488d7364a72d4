#include "front_end/voxel_thinning.h"

// The one filter that is used is compiled here: PCL's library of filters brings four more along,
// 35 MB in all.
#define PCL_NO_PRECOMPILE
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace hqslam::slam {

namespace {

constexpr float kReach_voxels = 1e6F;

/// PCL numbers the voxels of the points' box with 31 bits. Where they are more it prints a warning
/// and thins nothing; half as many are surely counted as it counts them.
constexpr double kMaxVoxels = 1 << 30;

/// The voxel of a point, counted as PCL does.
Eigen::Array3f voxel_of(const FeaturePoint& point, float leaf_m) {
  return (point.point_m.array() * (1.0F / leaf_m)).floor();
}

std::vector<FeaturePoint> within_reach(const std::vector<FeaturePoint>& points, float leaf_m) {
  std::vector<FeaturePoint> result;
  result.reserve(points.size());
  std::copy_if(points.begin(), points.end(), std::back_inserter(result), [&](const auto& point) {
    return (voxel_of(point, leaf_m).abs() < kReach_voxels).all();
  });
  return result;
}

/// Of points whose box has at most kMaxVoxels.
std::vector<FeaturePoint> thin_box(const std::vector<FeaturePoint>& points, float leaf_m) {
  auto cloud = pcl::make_shared<pcl::PointCloud<pcl::PointXYZINormal>>();
  cloud->reserve(points.size());
  for (const FeaturePoint& point : points) {
    pcl::PointXYZINormal pcl_point;
    pcl_point.getVector3fMap() = point.point_m;
    pcl_point.intensity = point.time_offset_s;       // averaged like the position
    pcl_point.getNormalVector3fMap() = point.slope;  // averaged, and made of length 1 again
    cloud->push_back(pcl_point);
  }
  pcl::VoxelGrid<pcl::PointXYZINormal> grid;
  grid.setLeafSize(leaf_m, leaf_m, leaf_m);
  grid.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZINormal> kept;
  grid.filter(kept);
  std::vector<FeaturePoint> result;
  result.reserve(kept.size());
  for (const pcl::PointXYZINormal& point : kept) {
    result.push_back({point.getVector3fMap(), point.intensity, points.front().row,
                      point.getNormalVector3fMap()});
  }
  return result;
}

/// Halves the box between two voxels until its parts are small enough.
std::vector<FeaturePoint> thin_in_parts(std::vector<FeaturePoint> points, float leaf_m) {
  if (points.empty()) return {};
  Eigen::Array3f first = voxel_of(points.front(), leaf_m);
  Eigen::Array3f last = first;
  for (const FeaturePoint& point : points) {
    first = first.min(voxel_of(point, leaf_m));
    last = last.max(voxel_of(point, leaf_m));
  }
  const Eigen::Array3f side = last - first + 1.0F;
  if (side.cast<double>().prod() <= kMaxVoxels) return thin_box(points, leaf_m);
  Eigen::Index longest = 0;
  const float half = std::floor(side.maxCoeff(&longest) / 2.0F);
  const auto upper = std::stable_partition(points.begin(), points.end(), [&](const auto& point) {
    return voxel_of(point, leaf_m)[longest] < first[longest] + half;
  });
  std::vector<FeaturePoint> result = thin_in_parts({points.begin(), upper}, leaf_m);
  const std::vector<FeaturePoint> rest = thin_in_parts({upper, points.end()}, leaf_m);
  result.insert(result.end(), rest.begin(), rest.end());
  return result;
}

}  // namespace

std::vector<FeaturePoint> thin(const std::vector<FeaturePoint>& points, double leaf_m) {
  const auto leaf = static_cast<float>(leaf_m);
  return thin_in_parts(within_reach(points, leaf), leaf);
}

}  // namespace hqslam::slam
