#pragma once

#include <cstddef>
#include <vector>

#include "hqslam/core/json_fields.h"

namespace hqslam {

/// The beams that an Ouster's metadata list, degrees, and which of them the sensor has.
struct OusterBeams {
  std::vector<double> altitude_deg;
  std::vector<double> azimuth_deg;  ///< clockwise
  /// Indices, from the first on. Firmware 1.13 lists and sends 64 beams for sensors of fewer, those
  /// that are lacking with altitude and azimuth 0.
  std::vector<std::size_t> present;
};

/// In: the object that holds beam_altitude_angles and beam_azimuth_angles. Throws Error.
OusterBeams ouster_beams(JsonFields& fields);

}  // namespace hqslam
