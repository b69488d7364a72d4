#include "hqslam/nn/training/augmentation.h"

#include "../random.h"

namespace hqslam::nn {
namespace {

/// The range if the sensor can see that far and that near, otherwise 0.
float within_limits(double range_m, const SensorModel& sensor) {
  const bool seen = range_m >= sensor.min_range_m && range_m <= sensor.max_range_m;
  return seen ? static_cast<float>(range_m) : 0.0F;
}

/// Noise and drop-outs on what the network sees.
void disturb(const Augmentation& augmentation, const SensorModel& sensor, Random& random,
             RangeImage& measured) {
  const double dropout = random.unit() * augmentation.largest_dropout_share;
  if (dropout <= 0.0 && augmentation.range_noise_m <= 0.0F) return;
  for (float& range_m : measured.range_m) {
    if (range_m <= 0.0F) continue;
    if (random.unit() < dropout) {
      range_m = 0.0F;
    } else {
      range_m += augmentation.range_noise_m * static_cast<float>(random.normal());
      range_m = within_limits(range_m, sensor);
    }
  }
}

}  // namespace

TrainingSample augmented_sample(const RangeImage& scan, const SensorModel& sensor,
                                RowSelection measured_rows, const Augmentation& augmentation,
                                std::uint64_t seed) {
  Random random(seed);
  const auto turn = static_cast<int>(random.below(scan.columns));
  const bool mirrored = augmentation.mirror && random.unit() < 0.5;
  const double scale = augmentation.smallest_scale +
                       random.unit() * (augmentation.largest_scale - augmentation.smallest_scale);
  const int columns = augmentation.crop_columns > 0 ? augmentation.crop_columns : scan.columns;
  TrainingSample sample;
  sample.truth = RangeImage(scan.rows, columns);
  for (int row = 0; row < scan.rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int from = (turn + (mirrored ? columns - 1 - column : column)) % scan.columns;
      sample.truth.at(row, column) = within_limits(scan.at(row, from) * scale, sensor);
    }
  }
  RangeImage& measured = sample.measured;
  for (int row = measured_rows.offset; row < scan.rows; row += measured_rows.stride) {
    const auto begin = sample.truth.range_m.begin() + row * columns;
    measured.range_m.insert(measured.range_m.end(), begin, begin + columns);
    ++measured.rows;
  }
  measured.columns = columns;
  disturb(augmentation, sensor, random, measured);
  return sample;
}

}  // namespace hqslam::nn
