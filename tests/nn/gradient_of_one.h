#pragma once

#include "hqslam/nn/network.h"

namespace hqslam::nn {

/// Network::add_gradients of one scan.
inline double add_gradient(Network& network, const TrainingSample& sample,
                           const LossOptions& options, std::span<float> d_parameters,
                           std::uint64_t seed = 0) {
  return network.add_gradients({&sample, 1}, options, {&seed, 1}, d_parameters);
}

}  // namespace hqslam::nn
