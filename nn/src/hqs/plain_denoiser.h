#pragma once

#include "denoiser.h"

namespace hqslam::nn {

/// Simple DU's denoiser: `convolutions` 3x3 convolutions of `features` channels on the whole image,
/// no bias, zeros beyond the edge, ReLU and dropout (training only) after all but the last.
struct PlainDenoiserShape {
  int features = 64;
  int convolutions = 5;
  float dropout = 0.05F;
};

/// Throws Error with field, value and constraint.
DenoiserDescription plain_denoiser(const PlainDenoiserShape& shape);
DenoiserDescription read_plain_denoiser(JsonFields& sizes);

}  // namespace hqslam::nn
