#include "parameters.h"

#include <fmt/format.h>

#include "hqslam/core/error.h"

namespace hqslam::nn::reference {

Parameters::Parameters(const NetworkDescription& description, std::span<const double> values) {
  const std::vector<ParameterShape> shapes = parameter_shapes(description);
  if (std::ssize(values) != elements(shapes)) {
    throw Error(
        fmt::format("reference: {} parameters, expected {}", values.size(), elements(shapes)));
  }
  for (const ParameterShape& shape : shapes) {
    const auto count = static_cast<std::size_t>(shape.elements());
    arrays_[shape.name] = {shape.shape, values.first(count)};
    values = values.subspan(count);
  }
}

}  // namespace hqslam::nn::reference
