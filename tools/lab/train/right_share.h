#pragma once

#include <functional>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/evaluation/image_error.h"
#include "train/recorded_drive.h"

namespace hqslam::tools {

/// Of the computed pixels that other scans measured (RecordedDrive), the share that is right
/// (within kRightRange_m) and the share that was left empty, each scan by scan; scans without such
/// pixels are left out.
struct PixelShares {
  std::vector<double> right;
  std::vector<double> missing;
};
/// upsample: the measured rows -> all rows.
PixelShares pixel_shares(const std::vector<nn::TrainingScan>& scans, const SensorModel& sensor,
                         RowSelection measured_rows,
                         const std::function<RangeImage(const RangeImage&)>& upsample);

double mean_of(const std::vector<double>& values);

/// The mean difference of two lists over the same scans, with its standard error over blocks of ten
/// consecutive scans, which show nearly the same.
struct Gain {
  double mean = 0.0;
  double standard_error = 0.0;
};
Gain gain_of(const std::vector<double>& before, const std::vector<double>& after);
/// Fewest scans for which gain_of gives a standard error.
inline constexpr std::size_t kFewestScansOfGain = 20;

}  // namespace hqslam::tools
