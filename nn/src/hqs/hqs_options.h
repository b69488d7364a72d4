#pragma once

#include "hqslam/nn/hqs/outlier_removal.h"
#include "hqslam/nn/trace.h"

namespace hqslam::nn {

/// The copies of H that the penalty pulls at it (eq. 5): Z of the learned prior and Y of the
/// outlier count, or Z alone. Without Y there is no filter inside.
enum class Auxiliaries { kZAndY, kZ };
/// What they are before the first layer: the measured ranges interpolated over rows, or 0.
enum class Start { kLinear, kZero };
/// How the penalty b is learned: its logarithm, "log_penalty", one of each layer; or "alpha" =
/// 1 / (2 b), one for all.
enum class Penalty { kLogOfEach, kAlpha };

inline constexpr int kMostLayers = 20;

/// Half-quadratic splitting, whatever the denoiser is.
struct HqsOptions {
  int layers = 5;               ///< K
  bool shared_weights = false;  ///< one denoiser for all layers
  Auxiliaries auxiliaries = Auxiliaries::kZAndY;
  Start start = Start::kLinear;
  Penalty penalty = Penalty::kLogOfEach;
  OutlierRemovalOptions filter;  ///< in every layer but the last
  /// On the last Z. Inside, a rejected pixel only takes Z; here it is lost, or a ghost stays.
  OutlierRemovalOptions last_filter;
  FilteredIterate filtered = FilteredIterate::kH;
  RejectedPixel rejected = RejectedPixel::kTakesZ;
};

}  // namespace hqslam::nn
