#pragma once

#include <span>

#include "golden_folder.h"
#include "hqslam/core/npz.h"
#include "hqslam/core/range_image.h"
#include "hqslam/nn/network_description.h"
#include "random_values.h"

// Files of tests/golden, made with PyTorch in float64 by tools/make_golden.py.
namespace hqslam::nn {

struct Golden {
  NpzArrays arrays;

  explicit Golden(const std::string& name)
      : arrays(read_npz(golden_folder() + "/" + name + ".npz")) {}

  bool has(const std::string& name) const { return arrays.contains(name); }
  const NpzArray& array(const std::string& name) const {
    REQUIRE_MESSAGE(arrays.contains(name), name);
    return arrays.at(name);
  }
  std::vector<float> values(const std::string& name) const {
    return float_values(array(name), name);
  }
  float value(const std::string& name) const { return values(name).at(0); }
  RangeImage image(const std::string& name) const {
    RangeImage image;
    image.rows = static_cast<int>(array(name).shape.at(0));
    image.columns = static_cast<int>(array(name).shape.at(1));
    image.range_m = values(name);
    return image;
  }
  /// Bytes that are 256ths.
  std::vector<float> fractions(const std::string& name) const {
    std::vector<float> fractions;
    for (const std::byte byte : array(name).bytes) {
      fractions.push_back(static_cast<float>(static_cast<std::int8_t>(byte)) / 256.0F);
    }
    return fractions;
  }
};

/// Channels x rows x columns as a tensor with its borders filled.
inline Tensor tensor_of(std::span<const float> values, int channels, int rows, int columns,
                        ColumnPadding padding = ColumnPadding::kCircular, int border_rows = 1) {
  Tensor tensor(channels, rows, columns, padding, border_rows);
  REQUIRE(values.size() == static_cast<std::size_t>(channels) * rows * columns);
  const float* next = values.data();
  for_each_value(tensor, 0, [&](int c, int y, int x) { tensor.at(c, y, x) = *next++; });
  tensor.fill_borders();
  return tensor;
}

inline std::vector<float> values_of(const Tensor& tensor) {
  std::vector<float> values;
  for_each_value(tensor, 0, [&](int c, int y, int x) { values.push_back(tensor.at(c, y, x)); });
  return values;
}

/// An array of scans x channels x rows x columns.
inline std::vector<Tensor> scans_of(const Golden& golden, const std::string& name,
                                    ColumnPadding padding = ColumnPadding::kCircular) {
  const std::vector<std::int64_t>& shape = golden.array(name).shape;
  const std::vector<float> values = golden.values(name);
  const std::size_t each = values.size() / shape.at(0);
  std::vector<Tensor> scans;
  for (std::int64_t scan = 0; scan < shape.at(0); ++scan) {
    scans.push_back(tensor_of(std::span(values).subspan(scan * each, each),
                              static_cast<int>(shape.at(1)), static_cast<int>(shape.at(2)),
                              static_cast<int>(shape.at(3)), padding));
  }
  return scans;
}

/// The largest difference, as a share of the largest value expected. Infinite where one is NaN.
template <typename Expected>
double relative_error(std::span<const float> actual, const std::vector<Expected>& expected) {
  REQUIRE(actual.size() == expected.size());
  double difference = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double d = std::fabs(static_cast<double>(actual[i]) - static_cast<double>(expected[i]));
    if (!(d < HUGE_VAL)) return HUGE_VAL;
    difference = std::max(difference, d);
    largest = std::max(largest, std::fabs(static_cast<double>(expected[i])));
  }
  REQUIRE(largest > 0.0);
  return difference / largest;
}

inline double relative_error(const Tensor& actual, const std::vector<float>& expected) {
  return relative_error(std::span<const float>(values_of(actual)), expected);
}

/// Gradients of a network's arrays, one after the other, each against its own largest value.
inline void check_arrays(std::span<const float> actual, const std::vector<float>& expected,
                         const std::vector<ParameterShape>& shapes, double tolerance) {
  REQUIRE(elements(shapes) == std::ssize(expected));
  auto first = expected.begin();
  for (const ParameterShape& shape : shapes) {
    CAPTURE(shape.name);
    const std::vector<float> part(first, first + shape.elements());
    CHECK(relative_error(actual.first(part.size()), part) < tolerance);
    actual = actual.subspan(part.size());
    first += shape.elements();
  }
}

}  // namespace hqslam::nn
