#include "hqslam/nn/training/augmentation.h"

#include "random.h"

namespace hqslam::nn {
namespace {

/// The range if it is within the sensor's limits, otherwise 0, or unknown if it was below 0.
float within_limits(double range_m, const SensorModel& sensor) {
  if (range_m < 0.0) {
    const bool is_range = within_limits(-range_m, sensor) > 0.0F;
    return is_range ? static_cast<float>(range_m) : kUnknownTruth_m;
  }
  const bool seen = range_m >= sensor.min_range_m && range_m <= sensor.max_range_m;
  return seen ? static_cast<float>(range_m) : 0.0F;
}

/// Adds noise and drop-outs to the measured rows.
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

TrainingSample augmented_sample(const TrainingScan& scan, const SensorModel& sensor,
                                RowSelection measured_rows, const Augmentation& augmentation,
                                std::uint64_t seed) {
  constexpr double kForgotten = 0.1;
  Random random(seed);
  const int rows = scan.truth.rows;
  const int all_columns = scan.truth.columns;
  const auto turn = static_cast<int>(random.below(all_columns));
  const bool mirrored = augmentation.mirror && random.unit() < 0.5;
  const double scale = augmentation.smallest_scale +
                       random.unit() * (augmentation.largest_scale - augmentation.smallest_scale);
  const int columns = augmentation.crop_columns > 0 ? augmentation.crop_columns : all_columns;
  const auto cut = [&](const RangeImage& image) {
    RangeImage result(rows, columns);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const int from = (turn + (mirrored ? columns - 1 - column : column)) % all_columns;
        result.at(row, column) = image.at(row, from);
      }
    }
    return result;
  };
  const auto scaled = [&](RangeImage image) {
    for (float& range_m : image.range_m) range_m = within_limits(range_m * scale, sensor);
    return image;
  };
  TrainingSample sample;
  sample.truth = scaled(cut(scan.truth));
  sample.measured = select_rows(sample.truth, measured_rows);
  disturb(augmentation, sensor, random, sample.measured);
  if (!scan.recalled.is_empty() && random.unit() >= kForgotten) {
    RangeImage weight = scan.recalled.image;
    weight.range_m = scan.recalled.weight;
    sample.recalled = {scaled(cut(scan.recalled.image)), cut(weight).range_m};
  }
  return sample;
}

}  // namespace hqslam::nn
