#pragma once

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "hqslam/core/pose.h"

namespace hqslam::lego_loam {

/// A point of the scan. As in LOAM, its intensity holds what the stages need: the image's row in
/// front of the decimal point, the moment of its capture behind it. A mean of points of one row
/// keeps the row and has the mean moment.
using Point = pcl::PointXYZI;
using Cloud = pcl::PointCloud<Point>;

/// sweep_fraction: 0 at the begin of the sweep, 1 at its end; kept from -0.49 to 1.49.
inline Point point_of(const Eigen::Vector3f& p_m, int row, double sweep_fraction) {
  const double moment = 0.25 + 0.5 * std::clamp(sweep_fraction, -0.49, 1.49);
  return {p_m.x(), p_m.y(), p_m.z(), static_cast<float>(row + moment)};
}
inline int row_of(const Point& point) { return static_cast<int>(point.intensity); }
inline double sweep_fraction(const Point& point) {
  return 2.0 * (point.intensity - std::floor(point.intensity) - 0.25F);
}
inline Eigen::Vector3d position_m(const Point& point) {
  return point.getVector3fMap().cast<double>();
}
inline Point moved(const Pose& T, Point point) {
  point.getVector3fMap() = (T * position_m(point)).cast<float>();
  return point;
}

/// One point per voxel of `leaf_m`, the mean of its points: pcl::VoxelGrid. A cloud with more
/// voxels than that can number is halved first.
Cloud thinned(const Cloud& cloud, float leaf_m);

/// A cloud with its kd-tree.
struct SearchCloud {
  explicit SearchCloud(const Cloud& points);
  /// Indices of the k points nearest to p, nearest first; none unless all are within reach_m.
  std::vector<int> nearest(const Point& p, int k, float reach_m) const;

  Cloud::Ptr cloud;
  pcl::KdTreeFLANN<Point> tree;
};

}  // namespace hqslam::lego_loam
