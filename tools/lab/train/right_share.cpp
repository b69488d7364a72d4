#include "train/right_share.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace hqslam::tools {

namespace {

constexpr std::size_t kBlockScans = kFewestScansOfGain / 2;

}  // namespace

PixelShares pixel_shares(const std::vector<nn::TrainingScan>& scans, const SensorModel& sensor,
                         RowSelection measured_rows,
                         const std::function<RangeImage(const RangeImage&)>& upsample) {
  PixelShares shares;
  for (const nn::TrainingScan& scan : scans) {
    const RangeImage image = upsample(select_rows(scan.truth, measured_rows));
    std::int64_t known = 0;
    std::int64_t right = 0;
    std::int64_t missing = 0;
    for (std::size_t i = 0; i < image.range_m.size(); ++i) {
      const float truth_m = scan.truth.range_m[i];
      if (truth_m >= 0.0F || truth_m <= -sensor.max_range_m) continue;
      ++known;
      right += std::fabs(image.range_m[i] + truth_m) < kRight_m;
      missing += image.range_m[i] <= 0.0F;
    }
    if (known == 0) continue;
    shares.right.push_back(static_cast<double>(right) / static_cast<double>(known));
    shares.missing.push_back(static_cast<double>(missing) / static_cast<double>(known));
  }
  return shares;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Gain gain_of(const std::vector<double>& before, const std::vector<double>& after) {
  std::vector<double> blocks;
  for (std::size_t first = 0; first + kBlockScans <= before.size(); first += kBlockScans) {
    double sum = 0.0;
    for (std::size_t i = first; i < first + kBlockScans; ++i) sum += after[i] - before[i];
    blocks.push_back(sum / kBlockScans);
  }
  const auto count = static_cast<double>(blocks.size());
  Gain gain{mean_of(blocks), 0.0};
  double squares = 0.0;
  for (const double block : blocks) squares += (block - gain.mean) * (block - gain.mean);
  gain.standard_error = std::sqrt(squares / std::max(count - 1.0, 1.0) / count);
  return gain;
}

}  // namespace hqslam::tools
