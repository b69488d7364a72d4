#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/connected_components.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "points.h"

namespace hqslam::lego_loam {

/// A point that segmentation kept.
struct SegmentedPoint {
  Point point;
  float range_m = 0.0F;
  int column = 0;
  bool ground = false;
};

struct SegmentedScan {
  std::vector<std::vector<SegmentedPoint>> rows;  ///< of the image, highest first; columns rise
  Cloud outliers;                                 ///< of clusters that are too small
  std::vector<std::int32_t> label;                ///< per pixel, see ScanTrace
  int ground_points = 0;
  int clusters = 0;
};

/// Section III-B. In: a scan as a range image with the point of each pixel.
///
/// Ground: of two points above one another in a column of the lowest rows, both are ground if the
/// line through them is at most 10 degrees steep. The rest falls into clusters: neighbours in row
/// or column (columns wrap) belong together if the angle beta between the farther beam and the line
/// through both points is above 60 degrees,
///   beta = atan2(d2 sin alpha, d1 - d2 cos alpha),  d1 >= d2, alpha the angle between the beams.
/// A cluster of 30 points is kept, and one of 5 points that spans 3 rows; the points of smaller
/// ones are outliers. Of the ground every fifth column is kept, so that it does not outweigh the
/// rest; of the outliers every fifth column above the ground's rows, for the map alone.
///
/// Differs from LeGO-LOAM: the program takes ground back where the pixel above has no return, which
/// makes clusters of what it took, and does not count the row of a cluster's first point. alpha
/// between rows is that of the beam table.
class Segmentation {
 public:
  explicit Segmentation(const SensorModel& sensor);
  SegmentedScan segment(const OrganizedCloud& cloud);

 private:
  double scan_period_s_;
  int ground_rows_;
  ComponentLabeler labeler_;
};

}  // namespace hqslam::lego_loam
