#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "velodyne_tables.h"

namespace hqslam::recordings {

/// A laser as one channel of a block.
struct VelodyneChannel {
  std::uint16_t row = 0;
  float cos_elevation = 1.0F;
  float sin_elevation = 0.0F;
  double clockwise = 0.0;   ///< hundredths of a degree
  double time_us = 0.0;     ///< after the first firing of the block
  double azimuth_us = 0.0;  ///< the same, for the interpolation of the azimuth
  float distance_m = 0.0F;  ///< VelodyneCalibration::Laser's; 0 without a calibration
  float up_m = 0.0F;
  float left_m = 0.0F;
};

/// Of the blocks of each bank.
using VelodyneChannels = std::array<std::vector<VelodyneChannel>, kBankFlags.size()>;

/// `sensor` gives elevation and azimuth offset of each row. Throws Error if it has not as many rows
/// as the model lasers, or if there is no calibration of an HDL-64E.
VelodyneChannels channels_of(const VelodyneStream& stream, const SensorModel& sensor);

/// The model's; but an HDL-64E's packets come as fast as its version sends them.
VelodyneTiming timing_of(const VelodyneStream& stream);

}  // namespace hqslam::recordings
