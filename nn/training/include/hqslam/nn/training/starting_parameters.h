#pragma once

#include <string>
#include <vector>

#include "hqslam/nn/network_description.h"
#include "hqslam/nn/weights_file.h"

namespace hqslam::nn {

/// The parameters of `weights` for a training of `network` to begin with: of the same arrays, or of
/// the same network without a scan memory; what the memory adds begins with 0. Throws Error with
/// `path` for any other network.
std::vector<float> parameters_to_start_from(const Weights& weights,
                                            const NetworkDescription& network,
                                            const std::string& path);

}  // namespace hqslam::nn
