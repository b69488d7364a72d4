#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// One point per pixel of a range image, the input of SLAM. Row and column are never recomputed
/// from coordinates.
struct OrganizedCloud {
  int rows = 0;
  int columns = 0;
  std::vector<Eigen::Vector3f> points_m;  ///< rows x columns, sensor frame; zero where no return
  std::vector<float> range_m;             ///< rows x columns; 0 where no return
  /// Capture time of each pixel minus the scan's stamp; empty: the scan is motion-corrected.
  std::vector<float> time_offset_s;
  /// Probability that the pixel's point is near a true surface, 0 to 1: 1 where it was measured, a
  /// network's estimate where it was computed. Empty: no point was computed, or its method gives no
  /// probability.
  std::vector<float> confidence;
  /// Brightness of each return in the unit of the recording (Scan::intensity); for a computed
  /// point, interpolated between the measured ones around it. Not a number where unknown. Empty:
  /// the recording has none.
  std::vector<float> intensity;

  OrganizedCloud() = default;
  OrganizedCloud(int rows_, int columns_);

  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * columns + column;
  }
};

OrganizedCloud select_rows(const OrganizedCloud& cloud, RowSelection rows);

/// The cloud with elevations and ranges corrected by the sensor's calibration
/// (SensorModel::elevation_correction_rad, range_correction_m), unchanged without one. Throws Error
/// if the cloud has other rows.
OrganizedCloud calibrated(OrganizedCloud cloud, const SensorModel& sensor);

/// The ranges of a cloud.
RangeImage range_image(const OrganizedCloud& cloud);

/// The points of the pixels that have a return.
std::vector<Eigen::Vector3f> points_of(const OrganizedCloud& cloud);

}  // namespace hqslam
