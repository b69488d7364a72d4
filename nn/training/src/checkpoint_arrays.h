#pragma once

#include <cstddef>
#include <string>

#include "hqslam/core/npz.h"
#include "hqslam/nn/training/checkpoint.h"

namespace hqslam::nn {

/// What read_checkpoint makes of the arrays of the file at `path`, for a network with this number
/// of parameters. Throws Error.
Checkpoint checkpoint_of(const NpzArrays& arrays, const std::string& path,
                         const std::string& configuration, std::size_t parameters,
                         const AdamWOptions& adamw);

}  // namespace hqslam::nn
