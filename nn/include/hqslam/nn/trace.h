#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/range_image.h"

namespace hqslam::nn {

/// Which image the outlier filter of a layer looks at: H (eq. 10c) or Z (the paper's prose).
enum class FilteredIterate { kH, kZ };
/// What Y is where the filter rejects a pixel: Z there, or 0 as eq. 10c has it. A 0 halves the
/// range in the next layer's mean of Z and Y and makes a new ghost; kZero is there to show it.
enum class RejectedPixel { kTakesZ, kZero };

/// The terms of eq. 5 after one layer, in m^2 over all pixels (mu J has no value: it is learned).
struct ObjectiveTerms {
  double data_m2 = 0.0;          ///< 1/2 |L - D H|^2
  double denoiser_gap_m2 = 0.0;  ///< b/2 |Z - H|^2
  double filter_gap_m2 = 0.0;    ///< b/2 |Y - H|^2; without Y there is no such term
  std::int64_t rejected = 0;     ///< pixels that Q rejects
};

/// What one layer computed, for people who want to look.
struct LayerTrace {
  /// Metres, after data consistency (eq. 10a); empty: the network is no unrolled loop, Z is what it
  /// says, rejected where its passes with dropout disagree, Y what remains.
  RangeImage h;
  RangeImage z;  ///< after the denoiser (eq. 10b)
  RangeImage y;  ///< after outlier removal (eq. 10c); without it: Z; DU-Mix: Z, empty where a
                 ///< return is unlikely
  std::vector<std::uint8_t> rejected;  ///< Q's mask, one per pixel; without Q empty
  FilteredIterate filtered = FilteredIterate::kH;
  RejectedPixel rejected_pixel = RejectedPixel::kTakesZ;
  std::vector<float> probability;  ///< DU-Mix: of a return, one per pixel; otherwise empty
  float penalty = 0.0F;            ///< b; DU-Mix: 0
  ObjectiveTerms objective;
};

struct Trace {
  RangeImage start;  ///< Z0 = Y0; empty where there are none
  std::vector<LayerTrace> layers;
  std::vector<std::uint8_t> rejected;  ///< by the filter at the end
};

}  // namespace hqslam::nn
