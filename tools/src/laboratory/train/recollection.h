#pragma once

#include <cstdint>
#include <random>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/scan_memory.h"

namespace hqslam::tools {

/// The measured rows of a drive's scans one after the other, and what each recalls of those before,
/// by poses as SLAM may have them.
class Recollection {
 public:
  Recollection(const SensorModel& sensor, RowSelection rows, std::uint64_t seed);
  /// The image of a scan with M and W^2 below it.
  RangeImage with_recalled(RangeImage image, const RangeImage& measured,
                           const nn::ColumnPoses& poses);
  void remember(const RangeImage& measured, const nn::ColumnPoses& poses, double stamp_s);

 private:
  SensorModel sensor_;  ///< the measured rows alone
  nn::ScanMemory memory_;
  std::mt19937_64 random_;
};

}  // namespace hqslam::tools
