#pragma once

#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/network.h"
#include "hqslam/nn/training/trainer.h"

// How a network's images differ from the truth at a comparable operating point.
namespace hqslam::nn {

/// What one scan adds, for every confidence below which pixels could be emptied.
struct ValidatedScan {
  /// Steps of confidence: bin i holds the computed pixels with i / kBins <= confidence < (i + 1) /
  /// kBins; pixels without a confidence are in the last bin.
  static constexpr int kBins = 1000;
  struct Bin {
    std::int64_t returns = 0;        ///< the network has a return
    std::int64_t wrong = 0;          ///< of them: more than 0.5 m off, or where truth has none
    std::int64_t found = 0;          ///< of them: truth has one too
    double error_sum_m = 0.0;        ///< |range - truth| of those found
    double invented_sum_m = 0.0;     ///< range where truth has none
    double truth_found_sum_m = 0.0;  ///< true range of those found: the error if they were emptied
  };
  std::vector<Bin> bins{kBins};
  std::int64_t pixels = 0;          ///< all, measured ones too
  std::int64_t measured_found = 0;  ///< measured pixels with a return
  std::int64_t true_returns = 0;    ///< computed pixels where truth has one
  double missed_sum_m = 0.0;        ///< true range where the network has no return at all
  Bin linear;                       ///< all computed pixels of linear interpolation
  double linear_missed_sum_m = 0.0;
};

ValidatedScan validated_scan(Network& network, const NetworkDescription& description,
                             const TrainingScan& scan);
/// The figures over all scans at the confidence where as many true returns are missing as linear
/// interpolation misses.
Validation validation_of(const std::vector<ValidatedScan>& scans);

}  // namespace hqslam::nn
