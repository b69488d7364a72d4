#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hqslam::nn {

/// One array of learned parameters, in PyTorch's layout.
struct ParameterShape {
  std::string name;  ///< "encoder.0.weight"
  std::vector<std::int64_t> shape;
  /// It follows the data that the network sees (batch norm) and is not learned; its gradient is its
  /// distance to them.
  bool statistic = false;
  std::int64_t elements() const;
};

/// Of all arrays together.
std::int64_t elements(const std::vector<ParameterShape>& shapes);

}  // namespace hqslam::nn
