#pragma once

#include <map>
#include <span>
#include <string>

#include "hqslam/nn/network_description.h"

namespace hqslam::nn::reference {

/// One learned array: its shape in PyTorch's layout, its values row-major.
struct Array {
  std::vector<std::int64_t> shape;
  std::span<const double> values;
};

/// The learned arrays of a network by their names.
class Parameters {
 public:
  /// values: all arrays of parameter_shapes(description), one after the other. Throws Error for
  /// another number.
  Parameters(const NetworkDescription& description, std::span<const double> values);
  const Array& operator[](const std::string& name) const { return arrays_.at(name); }

 private:
  std::map<std::string, Array> arrays_;
};

}  // namespace hqslam::nn::reference
