#pragma once

#include <string>

#include "hqslam/core/npz.h"
#include "hqslam/nn/hqs/weights_file.h"

namespace hqslam::nn {

/// What read_weights makes of the arrays of the file at `path`. Throws Error.
Weights weights_of(NpzArrays arrays, const std::string& path);

}  // namespace hqslam::nn
