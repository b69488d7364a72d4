#pragma once

#include <cstdint>
#include <optional>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/training/trainable_network.h"
#include "hqslam/nn/upsampled_image.h"

namespace hqslam::nn {

/// The truth of a pixel of which nothing is known.
inline constexpr float kUnknownTruth_m = -1e6F;

/// A sensor with all rows, and those that are measured.
struct ScanSensor {
  SensorModel sensor;
  RowSelection measured_rows;
};

/// A scan to learn from.
struct TrainingScan {
  /// All rows. Minus a range where it is known how far the surface is, because other scans measured
  /// it, but not whether this beam would have a return.
  RangeImage truth;
  RecalledImage recalled = {};  ///< of the scans before it; may be empty
  /// Of the scan, where it is not the network's; for a network that fits any sensor.
  std::optional<ScanSensor> sensor = {};
};

/// The random changes that make many samples of one scan.
struct Augmentation {
  int crop_columns = 0;                ///< a cut-out of this many columns; 0: the whole circle
  bool mirror = true;                  ///< left and right swapped, half of the time
  float smallest_scale = 0.9F;         ///< all ranges are multiplied by a number
  float largest_scale = 1.1F;          ///< between these two
  float range_noise_m = 0.0F;          ///< standard deviation, of the measured rows
  float largest_dropout_share = 0.0F;  ///< of the measured returns, between 0 and this are lost
};

/// A turned, mirrored, scaled cut-out of a scan. A seed gives the same sample on every machine.
/// Ranges that leave the sensor's limits are lost. One scan in ten comes without what is recalled,
/// as the first scan of every drive does.
TrainingSample augmented_sample(const TrainingScan& scan, const SensorModel& sensor,
                                RowSelection measured_rows, const Augmentation& augmentation,
                                std::uint64_t seed);

}  // namespace hqslam::nn
