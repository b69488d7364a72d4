#include "parameters.h"

namespace hqslam::nn {

std::int64_t ParameterShape::elements() const {
  std::int64_t product = 1;
  for (const std::int64_t extent : shape) product *= extent;
  return product;
}

void check_field(const char* field, int value, int least, int most) {
  if (value < least || value > most) {
    throw Error("network: {} is {}, expected {} to {}", field, value, least, most);
  }
}

void check_slope(float negative_slope) {
  check_that(negative_slope >= 0.0F && negative_slope <= 1.0F, "network", "negative_slope",
             negative_slope, "0 to 1");
}

void add_part(const std::string& name, const std::vector<ParameterShape>& arrays,
              std::vector<ParameterShape>& shapes) {
  for (ParameterShape array : arrays) {
    array.name = fmt::format("{}.{}", name, array.name);
    shapes.push_back(std::move(array));
  }
}

std::int64_t elements(const std::vector<ParameterShape>& shapes) {
  std::int64_t sum = 0;
  for (const ParameterShape& shape : shapes) sum += shape.elements();
  return sum;
}

void check_parameters(std::span<const float> parameters,
                      const std::vector<ParameterShape>& shapes) {
  if (static_cast<std::int64_t>(parameters.size()) != elements(shapes)) {
    throw Error("network: {} parameters, expected {}", parameters.size(), elements(shapes));
  }
}

void UniformStart::add(std::int64_t count, float limit, std::vector<float>& values) {
  for (std::int64_t i = 0; i < count; ++i) {
    const float unit = static_cast<float>(generator_() >> 40) / static_cast<float>(1 << 24);
    values.push_back(limit * (2.0F * unit - 1.0F));
  }
}

}  // namespace hqslam::nn
