#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// One point per pixel of a range image: row and column are never recomputed from coordinates.
/// This is what SLAM takes in.
struct OrganizedCloud {
  int rows = 0;
  int columns = 0;
  std::vector<Eigen::Vector3f> points_m;  ///< rows x columns, sensor frame; zero where no return
  std::vector<float> range_m;             ///< rows x columns; 0 where no return
  /// Capture time of each pixel minus the scan's stamp; empty: the scan is motion-corrected.
  std::vector<float> time_offset_s;
  /// Probability that the pixel's point lies near a true surface, 0 to 1: 1 where it was measured,
  /// what a network says of it where it was computed. Empty: no point was computed, or nothing is
  /// known of those that were.
  std::vector<float> confidence;
  /// How bright each return was, in the unit of the recording (Scan::intensity); of a computed
  /// point, what follows from the measured ones around it. Not a number where that is not known.
  /// Empty: the recording does not say.
  std::vector<float> intensity;

  OrganizedCloud() = default;
  OrganizedCloud(int rows_, int columns_);

  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * columns + column;
  }
};

OrganizedCloud select_rows(const OrganizedCloud& cloud, RowSelection rows);

/// Points and ranges where the sensor's calibration says that its beams look and what they measure
/// (SensorModel::elevation_correction_rad, range_correction_m); the cloud as it is where it says
/// nothing. Throws Error if the cloud has other rows.
OrganizedCloud calibrated(OrganizedCloud cloud, const SensorModel& sensor);

/// The ranges alone.
RangeImage range_image(const OrganizedCloud& cloud);

/// The points of the pixels that have a return.
std::vector<Eigen::Vector3f> points_of(const OrganizedCloud& cloud);

}  // namespace hqslam
