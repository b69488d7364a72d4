#pragma once

#include <Eigen/Core>
#include <vector>

#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// The column of a point, for all points of a scan.
///
/// In:  the row and the point, sensor frame, metres. Out: SensorModel::column_of(row, atan2(y, x)),
///      the very same number, in a third of the time.
/// The azimuth is looked up: atan of the smaller of |x|, |y| by the larger one, straight lines
/// between 257 values, wrong by at most 1.3e-6 rad (h^2 / 8 max|atan''|, h = 1/256, and rounding).
/// That is less than 0.004 columns for any sensor; what comes nearer than four times as much to the
/// edge of a column is computed in full.
class ColumnFinder {
 public:
  explicit ColumnFinder(const SensorModel& sensor);
  int column(int row, const Eigen::Vector3f& point_m) const;

 private:
  const SensorModel& sensor_;
  double columns_per_rad_;
  std::vector<float> arc_tangent_rad_;
  std::vector<double> residual_azimuth_rad_;  ///< of each row
};

}  // namespace hqslam
