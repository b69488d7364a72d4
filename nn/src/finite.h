#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "hqslam/core/error.h"

namespace hqslam::nn {

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
