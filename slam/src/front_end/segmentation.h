#pragma once

#include <vector>

#include "hqslam/core/connected_components.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/scan_trace.h"

namespace hqslam::slam {

struct Segmentation {
  std::vector<PixelClass> pixel_class;
  int returns = 0;
  int ground_points = 0;
  int clusters = 0;  ///< trusted ones
};

/// Splits the returns of a scan into ground, clusters and outliers.
///
/// In: a cloud in the level frame, the vertical (mark_ground). Out: a class per pixel. The ground
/// is marked first (mark_ground); the other returns form connected components by the angle
/// criterion; a component is a cluster if it has min_pixels, or min_pixels_tall over min_rows_tall
/// rows. Source: LeGO-LOAM.
///
/// Differs from LeGO-LOAM: the rows of a component count the row of its first pixel; column
/// indices are signed and wrap on both sides; the components are those of core, the same as the
/// outlier filter's.
class Segmenter {
 public:
  /// Throws Error if an option is invalid.
  Segmenter(const SensorModel& sensor, const GroundOptions& ground,
            const SegmentationOptions& options);
  Segmentation segment(const OrganizedCloud& cloud,
                       const Eigen::Vector3d& up_of_sensor = Eigen::Vector3d::UnitZ());

 private:
  SensorModel sensor_;
  GroundOptions ground_;
  SegmentationOptions options_;
  ComponentLabeler labeler_;
};

}  // namespace hqslam::slam
