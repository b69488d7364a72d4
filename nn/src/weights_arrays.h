#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/core/npz.h"
#include "hqslam/nn/weights_file.h"

namespace hqslam::nn {

/// What read_weights makes of the arrays of the file at `path`. Throws Error.
Weights weights_of(NpzArrays arrays, const std::string& path,
                   const Architectures& architectures = hqs_architectures());

/// The values of the array `name` of the file at `path`. Throws Error unless all are finite.
template <typename Value>
std::vector<Value> finite(std::vector<Value> values, const std::string& path,
                          const std::string& name) {
  for (const Value value : values) {
    if (!std::isfinite(value)) {
      throw Error("{}: array '{}': expected finite values, found {}", path, name, value);
    }
  }
  return values;
}

}  // namespace hqslam::nn
