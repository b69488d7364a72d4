#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/nn/network_description.h"

// What every network does with its parameters.
namespace hqslam::nn {

/// Takes the next `count` values off the front.
template <typename T>
std::span<T> take(std::span<T>& values, std::int64_t count) {
  const std::span<T> front = values.first(static_cast<std::size_t>(count));
  values = values.subspan(static_cast<std::size_t>(count));
  return front;
}

/// Throws Error with the field, its value and what was expected, unless `good`.
template <typename Value>
void check_that(bool good, const char* what, const char* field, Value value, const char* expected) {
  if (!good) throw Error("{}: {} is {}, expected {}", what, field, value, expected);
}
/// Throws Error unless least <= value <= most.
void check_field(const char* field, int value, int least, int most);
/// Throws Error unless 0 to 1, as the slope of a leaky ReLU is.
void check_slope(float negative_slope);

/// Appends the arrays of a part of the network, its name before theirs: "layers.0.head.weight".
void add_part(const std::string& name, const std::vector<ParameterShape>& arrays,
              std::vector<ParameterShape>& shapes);

/// Throws Error unless there are as many parameters as the shapes hold.
void check_parameters(std::span<const float> parameters, const std::vector<ParameterShape>& shapes);

/// Uniform starting values. PyTorch's limit for weights and biases is 1 / sqrt(fan in).
class UniformStart {
 public:
  explicit UniformStart(std::uint64_t seed) : generator_(seed) {}
  /// Appends `count` values in +-limit.
  void add(std::int64_t count, float limit, std::vector<float>& values);

 private:
  std::mt19937_64 generator_;
};

}  // namespace hqslam::nn
