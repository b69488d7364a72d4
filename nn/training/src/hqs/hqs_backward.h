#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "hqs/hqs_loop.h"
#include "prior_backward.h"

namespace hqslam::nn {

/// What hqs_backward works in.
struct HqsGradient {
  /// The loop must outlive it.
  explicit HqsGradient(Hqs& hqs);
  /// The loop's new parameters, which it has already.
  void take_parameters(std::span<const float> parameters);

  PriorBackward& backward(int k) { return *priors[k % priors.size()]; }

  std::vector<std::shared_ptr<PriorBackward>> priors;  ///< of each layer, or one for all
  std::int64_t prior_parameters;                       ///< of one of them
  PriorState prior;
  Tensor d_h;
  Tensor d_a;  ///< of the layer above: A is the mean of its Z and Y; without Y it is Z
};

/// Returns the loss of layer k and writes its gradient (PriorBackward::loss).
using LayerLoss = std::function<double(int k, const PriorState& state, PriorState& gradient)>;
/// From the last layer to the first, after hqs_loop with a state for it; the filter's masks are
/// constants. Adds to d_parameters and returns the last layer's loss. By a team of one thread.
double hqs_backward(Hqs& hqs, const HqsState& state, const LayerLoss& loss, HqsGradient& scratch,
                    std::span<float> d_parameters);

/// d_h: d loss / d H. Writes d loss / d A to d_a and returns the row's part of d loss / d b.
double data_consistency_gradient_row(const float* l, const float* z, const float* y,
                                     const float* d_h, float penalty, int columns, float* d_a);

}  // namespace hqslam::nn
