#pragma once

#include "hqslam/nn/architectures.h"

namespace hqslam::nn {

/// The architectures of hqs_architectures(), and SRAE, with which they are compared.
const Architectures& all_architectures();

}  // namespace hqslam::nn
