#pragma once

#include "hqslam/nn/architectures.h"

namespace hqslam::nn {

/// Those of hqs_architectures() and the network that they are compared with, SRAE.
const Architectures& all_architectures();

}  // namespace hqslam::nn
