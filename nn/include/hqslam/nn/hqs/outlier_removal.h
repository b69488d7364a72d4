#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/sensor_model.h"

namespace hqslam::nn {

struct OutlierRemovalOptions {
  /// Neighbouring pixels are connected if the angle between the longer beam and the line through
  /// both points is larger than this.
  double min_angle_rad = 0.17453292519943295;  // 10 degrees
  /// Components of fewer pixels are rejected.
  int min_pixels = 20;
};

/// Q of eq. 10c: which pixels of a range image belong to small connected components. The
/// components are those that a breadth-first search over N4 neighbours finds (ComponentLabeler in
/// core, which the tests compare with), found here from runs of connected pixels in each row that
/// are merged with union-find: several times as fast.
class OutlierRemoval {
 public:
  /// `columns` may be fewer than the sensor's: a cut-out of a scan, closed to a circle. Throws
  /// Error unless 0 < min_angle < pi/2, min_pixels >= 0 and 1 <= columns <= sensor.columns.
  OutlierRemoval(const SensorModel& sensor, RowSelection measured_rows,
                 const OutlierRemovalOptions& options, int columns);

  /// range_m: rows x columns, metres, row-major, 0 = no return. rejected: the same shape, 1 where
  /// the pixel is rejected, otherwise 0. Pixels of measured rows and pixels without a return are
  /// never rejected. Uses up to `threads` OpenMP threads; the result does not depend on it. After
  /// the first call no call allocates.
  void find(const float* range_m, std::uint8_t* rejected, int threads = 1);

  int rows() const { return rows_; }
  int columns() const { return columns_; }

 private:
  int rows_;
  int columns_;
};

}  // namespace hqslam::nn
