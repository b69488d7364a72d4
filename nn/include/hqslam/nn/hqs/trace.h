#pragma once

#include <cstdint>
#include <vector>

#include "hqslam/core/range_image.h"

namespace hqslam::nn {

/// The terms of eq. 3 after one layer, in m^2 over all pixels (mu J has no value: it is learned).
struct ObjectiveTerms {
  double data_m2 = 0.0;          ///< 1/2 |L - D H|^2
  double denoiser_gap_m2 = 0.0;  ///< b/2 |Z - H|^2
  double filter_gap_m2 = 0.0;    ///< b/2 |Y - H|^2; Simple DU has no such term
  std::int64_t rejected = 0;     ///< pixels that Q rejects
};

/// What one layer computed, for people who want to look.
struct LayerTrace {
  RangeImage h;  ///< metres, after data consistency (eq. 10a)
  RangeImage z;  ///< after the denoiser (eq. 10b)
  RangeImage y;  ///< after outlier removal (eq. 10c); Simple DU: Z; DU-Mix: Z, empty where a return
                 ///< is unlikely
  std::vector<std::uint8_t> rejected;  ///< Q's mask, one per pixel; Simple DU and DU-Mix: all 0
  std::vector<float> probability;      ///< DU-Mix: of a return, one per pixel; otherwise empty
  float penalty = 0.0F;                ///< b; DU-Mix: 0
  ObjectiveTerms objective;
};

struct Trace {
  RangeImage start;  ///< Z0 = Y0
  std::vector<LayerTrace> layers;
  std::vector<std::uint8_t> rejected;  ///< by the filter at the end
};

}  // namespace hqslam::nn
