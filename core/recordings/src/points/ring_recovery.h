#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::recordings {

struct RingRecovery {
  std::vector<std::uint16_t> row;  ///< per point, 0 the highest beam
  int spurious_wraps = 0;          ///< azimuth wraps that did not begin a new ring
  int missed_wraps = 0;            ///< rings that began without a wrap
  int empty_rings = 0;             ///< rings of the sensor without a point
  /// Share of the points in rings that do not follow the beam table: near 0 for scans of this
  /// sensor.
  double off_table_share = 0.0;
};

/// Whether the points are stored ring after ring (KITTI) rather than column after column, as by
/// drivers that write the beams of each firing together.
bool stored_ring_after_ring(const Scan& scan, const SensorModel& sensor);

/// Rows of a scan whose points are stored ring after ring, highest first, each ring once around in
/// azimuth in either direction, beginning in front (KITTI) or at the back: from the wraps of the
/// azimuth, checked against the beam table. Survives spurious and missing wraps and empty rings.
/// Throws Error if the points are in no such order.
RingRecovery recover_rings(const Scan& scan, const SensorModel& sensor);

}  // namespace hqslam::recordings
