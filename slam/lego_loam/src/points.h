#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "hqslam/core/pose.h"

namespace hqslam::lego_loam {

/// A point of the scan. As in LOAM its intensity holds what the stages need to know of it: the
/// image's row in front of the decimal point, behind it the moment of its capture. A voxel's mean
/// of points of one row keeps the row and the mean moment.
using Point = pcl::PointXYZI;
using Cloud = pcl::PointCloud<Point>;

/// sweep_fraction: 0 at the begin of the sweep, 1 at its end; times from half a sweep before to
/// half a sweep behind are kept.
inline Point point_of(const Eigen::Vector3f& point_m, int row, float sweep_fraction) {
  const float moment = 0.25F + 0.5F * std::clamp(sweep_fraction, -0.49F, 1.49F);
  Point point;
  point.getVector3fMap() = point_m;
  point.intensity = static_cast<float>(row) + moment;
  return point;
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

Cloud moved(const Pose& T, const Cloud& cloud);

/// One point per voxel of `leaf_m`, the mean of its points: pcl::VoxelGrid. Clouds that have more
/// voxels than that can number are halved first.
Cloud thinned(const Cloud& cloud, float leaf_m);

}  // namespace hqslam::lego_loam
