#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/scan.h"

/// Clouds of the Point Cloud Library and back. Link hqslam::pcl. Do not compile code that includes
/// PCL for wider vectors (-march=native, -mavx) than PCL itself was: it crashes.
namespace hqslam {

inline pcl::PointXYZI pcl_point(const Eigen::Vector3f& point_m, float intensity) {
  return {point_m.x(), point_m.y(), point_m.z(), intensity};
}

/// Organized as the image, row 0 the highest beam: width columns, height rows, not a number where
/// there is no return. PCL's points have no capture time and no confidence. An intensity that is
/// not known is 0.
inline pcl::PointCloud<pcl::PointXYZI> pcl_cloud(const OrganizedCloud& cloud) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  pcl::PointCloud<pcl::PointXYZI> result(cloud.columns, cloud.rows);
  result.is_dense = false;
  for (std::size_t pixel = 0; pixel < result.size(); ++pixel) {
    const bool has_return = cloud.range_m[pixel] > 0.0F;
    const float intensity = cloud.intensity.empty() ? 0.0F : cloud.intensity[pixel];
    result[pixel] = has_return ? pcl_point(cloud.points_m[pixel], intensity)
                               : pcl_point(Eigen::Vector3f::Constant(kNan), 0.0F);
  }
  return result;
}

/// An organized cloud of PCL; a point that is not finite or at the origin is no return. A cloud
/// that is not organized becomes one row: hqslam::project gives such a one its rows and columns.
inline OrganizedCloud organized_cloud(const pcl::PointCloud<pcl::PointXYZI>& cloud) {
  OrganizedCloud result(static_cast<int>(cloud.height), static_cast<int>(cloud.width));
  result.intensity.assign(cloud.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t pixel = 0; pixel < cloud.size(); ++pixel) {
    const Eigen::Vector3f point_m = cloud[pixel].getVector3fMap();
    const float range_m = point_m.norm();
    if (!std::isfinite(range_m) || range_m == 0.0F) continue;
    result.points_m[pixel] = point_m;
    result.range_m[pixel] = range_m;
    result.intensity[pixel] = cloud[pixel].intensity;
  }
  return result;
}

/// The points of a scan in its order; an intensity that is not known is 0.
inline pcl::PointCloud<pcl::PointXYZI> pcl_cloud(const Scan& scan) {
  pcl::PointCloud<pcl::PointXYZI> result;
  for (std::size_t i = 0; i < scan.points_m.size(); ++i) {
    result.push_back(
        pcl_point(scan.points_m[i], scan.intensity.empty() ? 0.0F : scan.intensity[i]));
  }
  return result;
}

/// The finite points of a cloud, without rows and times; the others are counted as invalid.
inline Scan scan_of(const pcl::PointCloud<pcl::PointXYZI>& cloud) {
  Scan result;
  for (const pcl::PointXYZI& point : cloud) {
    if (!point.getVector3fMap().allFinite()) {
      ++result.invalid_points;
      continue;
    }
    result.points_m.push_back(point.getVector3fMap());
    result.intensity.push_back(point.intensity);
  }
  return result;
}

}  // namespace hqslam
