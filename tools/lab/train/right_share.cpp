#include "train/right_share.h"

#include <algorithm>
#include <cmath>
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
    RangeImage others = scan.truth;  // what other scans measured between the measured rows
    for (float& range_m : others.range_m) {
      const bool is_known = range_m < 0.0F && range_m > -sensor.max_range_m;
      range_m = is_known ? -range_m : 0.0F;
    }
    if (std::ranges::none_of(others.range_m, [](float range_m) { return range_m > 0.0F; }))
      continue;
    const ImageError error = image_error(upsample(select_rows(scan.truth, measured_rows)), others);
    shares.right.push_back(error.right_share);
    shares.missing.push_back(error.missing_share);
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
