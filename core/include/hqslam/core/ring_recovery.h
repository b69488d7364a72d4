#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

struct RingRecovery {
  std::vector<std::uint16_t> row;  ///< per point, 0 the highest beam
  int spurious_wraps = 0;          ///< azimuth wraps that did not begin a new ring
  int missed_wraps = 0;            ///< rings that began without a wrap
  int empty_rings = 0;             ///< rings of the sensor without a point
};

/// Rows of a scan whose points are stored ring after ring, highest first, each ring once around in
/// azimuth (KITTI's HDL-64E files): from the wraps of the azimuth, checked against the beam table.
RingRecovery recover_rings(const Scan& scan, const SensorModel& sensor);

}  // namespace hqslam
