#pragma once

#include "prior.h"

namespace hqslam::nn {

/// Simple DU's denoiser: `convolutions` 3x3 convolutions of `features` channels on the whole image,
/// no bias, zeros beyond the edge, ReLU and dropout (training only) after all but the last.
struct PlainPriorShape {
  int features = 64;
  int convolutions = 5;
  float dropout = 0.05F;
};

class PlainPrior final : public Prior {
 public:
  explicit PlainPrior(LayerGraph graph) : Prior(std::move(graph), {1, 1}) {}

  void forward(const Candidates& candidates, PriorState& state, const PriorPass& pass) override;
  /// Whether the last `forward` did.
  bool dropped_out() const { return dropped_out_; }

 private:
  bool dropped_out_ = false;
};

/// Throws Error with field, value and constraint.
PriorDescription plain_prior(const PlainPriorShape& shape);
PriorDescription read_plain_prior(JsonFields& sizes);

}  // namespace hqslam::nn
