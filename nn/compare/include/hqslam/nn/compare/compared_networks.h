#pragma once

#include "hqslam/nn/architectures.h"

namespace hqslam::nn {

/// Those of hqs_architectures() and the networks that they are compared with, SRAE and TULIP.
const Architectures& all_architectures();

}  // namespace hqslam::nn
