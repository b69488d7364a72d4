#pragma once

#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/scan_trace.h"

namespace hqslam::slam {

struct Segmentation {
  std::vector<PixelClass> pixel_class;
  Eigen::Vector3d up =
      Eigen::Vector3d::UnitZ();  ///< the ground's normal, about, in the cloud's frame
  int returns = 0;
  int ground_points = 0;
};

/// Splits the returns of a scan into the ground (mark_ground) and what stands on it.
///
/// Differs from LeGO-LOAM: components that are too small are not left out, but short rings are
/// (features.cpp). Most of what small components have is no noise, and without it registration is
/// less accurate.
Segmentation segment(const OrganizedCloud& cloud, const SensorModel& sensor,
                     const Eigen::Vector3d& up_of_sensor = Eigen::Vector3d::UnitZ());

}  // namespace hqslam::slam
