#include "validation.h"

#include <algorithm>
#include <cmath>

#include "hqslam/nn/interpolation.h"

namespace hqslam::nn {
namespace {

constexpr float kTolerance_m = 0.5F;

void add_pixel(float range_m, float truth_m, float confidence, ValidatedScan& scan) {
  if (truth_m > 0.0F) ++scan.true_returns;
  if (range_m <= 0.0F) {
    scan.missed_sum_m += truth_m;
    return;
  }
  const int place =
      std::clamp(static_cast<int>(confidence * ValidatedScan::kBins), 0, ValidatedScan::kBins - 1);
  ValidatedScan::Bin& bin = scan.bins[place];
  ++bin.returns;
  if (truth_m <= 0.0F) {
    ++bin.wrong;
    bin.invented_sum_m += range_m;
    return;
  }
  const float off_m = std::fabs(range_m - truth_m);
  if (off_m > kTolerance_m) ++bin.wrong;
  ++bin.found;
  bin.error_sum_m += off_m;
  bin.truth_found_sum_m += truth_m;
}

ValidatedScan compared(const UpsampledImage& upsampled, const RangeImage& truth,
                       RowSelection measured) {
  ValidatedScan scan;
  scan.pixels = static_cast<std::int64_t>(truth.range_m.size());
  for (int row = 0; row < truth.rows; ++row) {
    for (int column = 0; column < truth.columns; ++column) {
      const std::size_t i = truth.index(row, column);
      if (measured.contains(row)) {
        if (truth.range_m[i] > 0.0F) ++scan.measured_found;
        continue;
      }
      add_pixel(upsampled.image.range_m[i], truth.range_m[i],
                upsampled.confidence.empty() ? 1.0F : upsampled.confidence[i], scan);
    }
  }
  return scan;
}

void add(const ValidatedScan::Bin& from, ValidatedScan::Bin& to) {
  to.returns += from.returns;
  to.wrong += from.wrong;
  to.found += from.found;
  to.error_sum_m += from.error_sum_m;
  to.invented_sum_m += from.invented_sum_m;
  to.truth_found_sum_m += from.truth_found_sum_m;
}

void add(const ValidatedScan& from, ValidatedScan& to) {
  for (int i = 0; i < ValidatedScan::kBins; ++i) add(from.bins[i], to.bins[i]);
  add(from.linear, to.linear);
  to.linear_missed_sum_m += from.linear_missed_sum_m;
  to.pixels += from.pixels;
  to.measured_found += from.measured_found;
  to.true_returns += from.true_returns;
  to.missed_sum_m += from.missed_sum_m;
}

/// kept: the pixels that came out with a return; the others lack missed_sum_m.
ImageFigures figures(const ValidatedScan::Bin& kept, double missed_sum_m,
                     const ValidatedScan& scan) {
  const auto share = [](double part, std::int64_t whole) {
    return whole > 0 ? part / static_cast<double>(whole) : 0.0;
  };
  return {.mae_all_m = share(kept.error_sum_m + kept.invented_sum_m + missed_sum_m, scan.pixels),
          .mae_valid_m = share(kept.error_sum_m, kept.found + scan.measured_found),
          .wrong_share = share(static_cast<double>(kept.wrong), kept.returns),
          .missing_share =
              share(static_cast<double>(scan.true_returns - kept.found), scan.true_returns)};
}

/// The network's with everything below bin `first` emptied.
ImageFigures figures_from(const ValidatedScan& scan, int first) {
  ValidatedScan::Bin kept;
  double missed_sum_m = scan.missed_sum_m;
  for (int i = 0; i < ValidatedScan::kBins; ++i) {
    if (i < first) {
      missed_sum_m += scan.bins[i].truth_found_sum_m;
    } else {
      add(scan.bins[i], kept);
    }
  }
  return figures(kept, missed_sum_m, scan);
}

/// The exponent from 0.3 to 3 with the smallest sum of squares between c^exponent and 1 for what is
/// right, 0 for what is wrong (Brier score).
double best_exponent(const ValidatedScan& scan) {
  double best = 1.0;
  double least = HUGE_VAL;
  for (int percent = 30; percent <= 300; ++percent) {
    double score = 0.0;
    for (int i = 0; i < ValidatedScan::kBins; ++i) {
      const ValidatedScan::Bin& bin = scan.bins[i];
      const double stated = std::pow((i + 0.5) / ValidatedScan::kBins, 0.01 * percent);
      const auto wrong = static_cast<double>(bin.wrong);
      const double right = static_cast<double>(bin.returns) - wrong;
      score += right * (1.0 - stated) * (1.0 - stated) + wrong * stated * stated;
    }
    if (score < least) {
      least = score;
      best = 0.01 * percent;
    }
  }
  return best;
}

}  // namespace

ValidatedScan validated_scan(Network& network, const NetworkDescription& description,
                             const TrainingScan& seen) {
  const RowSelection rows = description.measured_rows;
  const RangeImage& truth = seen.truth;
  const RangeImage measured = select_rows(truth, rows);
  ValidatedScan scan =
      compared(network.upsample({measured, seen.recalled}, kTolerance_m), truth, rows);
  const UpsampledImage linear{
      interpolate_rows(measured, rows, description.sensor.beam_elevation_rad,
                       Interpolation::kLinear),
      {}};
  const ValidatedScan of_linear = compared(linear, truth, rows);
  scan.linear = of_linear.bins.back();  // it has no confidence
  scan.linear_missed_sum_m = of_linear.missed_sum_m;
  return scan;
}

Validation validation_of(const std::vector<ValidatedScan>& scans) {
  ValidatedScan sum;
  Validation validation;
  for (const ValidatedScan& scan : scans) add(scan, sum);
  validation.linear = figures(sum.linear, sum.linear_missed_sum_m, sum);
  // From the most confident pixels down, until no more are missing than linear interpolation's.
  int first = ValidatedScan::kBins - 1;
  const auto missing = [&](int bin) { return figures_from(sum, bin).missing_share; };
  int low = 0;
  while (low < first) {
    const int middle = (low + first + 1) / 2;
    if (missing(middle) <= validation.linear.missing_share) {
      low = middle;
    } else {
      first = middle - 1;
    }
  }
  validation.network = figures_from(sum, low);
  validation.least_confidence = static_cast<double>(low) / ValidatedScan::kBins;
  validation.confidence_exponent = best_exponent(sum);
  return validation;
}

}  // namespace hqslam::nn
