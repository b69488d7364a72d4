#include "hqslam/core/npz.h"

#include <bit>
#include <cstring>
#include <utility>

#include "files/npy_format.h"
#include "hqslam/core/error.h"

namespace hqslam {

static_assert(std::endian::native == std::endian::little, "files are little-endian, and so are we");

namespace {

template <typename T>
NpzArray array_of(const char* dtype, const std::vector<T>& values,
                  std::vector<std::int64_t> shape) {
  NpzArray array;
  array.dtype = dtype;
  array.shape = std::move(shape);
  if (array.elements() != static_cast<std::int64_t>(values.size())) {
    throw Error("expected {} values for an array of shape {}, found {}", array.elements(),
                npy_shape_text(array.shape), values.size());
  }
  array.bytes.resize(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(array.bytes.data(), values.data(), array.bytes.size());
  return array;
}

template <typename T>
std::vector<T> values_of(const char* dtype, const NpzArray& array, const std::string& name) {
  if (array.dtype != dtype) {
    throw Error("{}: expected an array of dtype '{}', found '{}'; convert with array.astype('{}')",
                name, dtype, array.dtype, dtype);
  }
  const auto expected = static_cast<std::size_t>(array.elements()) * sizeof(T);
  if (array.bytes.size() != expected) {
    throw Error("{}: expected {} bytes for shape {}, found {}", name, expected,
                npy_shape_text(array.shape), array.bytes.size());
  }
  std::vector<T> values(array.bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), array.bytes.data(), array.bytes.size());
  return values;
}

}  // namespace

std::int64_t NpzArray::elements() const {
  const auto count = npz_element_count(shape);
  if (!count) {
    throw Error(
        "expected an array shape without negative sizes and of less than 2^59 elements, found {}",
        npy_shape_text(shape));
  }
  return *count;
}

NpzArray npz_array(const std::vector<float>& values, std::vector<std::int64_t> shape) {
  return array_of("<f4", values, std::move(shape));
}

NpzArray npz_array(const std::vector<double>& values, std::vector<std::int64_t> shape) {
  return array_of("<f8", values, std::move(shape));
}

NpzArray npz_array(const std::vector<std::int64_t>& values, std::vector<std::int64_t> shape) {
  return array_of("<i8", values, std::move(shape));
}

NpzArray npz_text(const std::string& text) {
  return array_of("|u1", std::vector<char>(text.begin(), text.end()),
                  {static_cast<std::int64_t>(text.size())});
}

std::vector<float> float_values(const NpzArray& array, const std::string& name) {
  return values_of<float>("<f4", array, name);
}

std::vector<double> double_values(const NpzArray& array, const std::string& name) {
  return values_of<double>("<f8", array, name);
}

std::vector<std::int64_t> int64_values(const NpzArray& array, const std::string& name) {
  return values_of<std::int64_t>("<i8", array, name);
}

std::string text_value(const NpzArray& array, const std::string& name) {
  const std::vector<char> characters = values_of<char>("|u1", array, name);
  if (array.shape.size() != 1) {
    throw Error("{}: expected text as a one-dimensional array, found shape {}", name,
                npy_shape_text(array.shape));
  }
  return {characters.begin(), characters.end()};
}

}  // namespace hqslam
