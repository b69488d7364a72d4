#pragma once

#include <vector>

#include "front_end/features.h"
#include "hqslam/core/connected_components.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::slam::as_published {

/// A point that segmentation kept.
struct SegmentedPoint {
  FeaturePoint point;  ///< row 0 is the lowest beam
  float range_m = 0.0F;
  int column = 0;
  bool ground = false;
};

/// A scan as the published program hands it on: row after row from the lowest.
struct SegmentedScan {
  std::vector<SegmentedPoint> points;
  /// Per row: index of its sixth kept point and of its sixth last, between which features are
  /// chosen; the program is off by one here, so a row's bounds begin with the point before it.
  std::vector<int> first;
  std::vector<int> last;
  std::vector<FeaturePoint> outliers;  ///< of every fifth column, above the rows of the ground
};

/// LeGO-LOAM's image projection, ground and segmentation, with its preset per number of rows.
///
/// Ground: of the lowest rows (7 of 16, 15 of 64) pairs whose line is less than 10 degrees steep;
/// of it every fifth column is kept. The rest falls into components by an angle of 60 degrees;
/// those of 30 points are kept, or of 5 over 3 rows, where the row of the first point counts only
/// if another point of it does.
class ImageProjection {
 public:
  explicit ImageProjection(const SensorModel& sensor);
  SegmentedScan segment(const OrganizedCloud& cloud);

 private:
  SensorModel sensor_;
  int ground_rows_;
  ComponentLabeler labeler_;
};

}  // namespace hqslam::slam::as_published
