#pragma once

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

#include "hqslam/core/npz.h"
#include "readers.h"

namespace hqslam::fuzz {

inline constexpr std::size_t kReplacedHead = 3;

/// An array in place of a good one. The checksums of a zip archive would keep random changes of its
/// bytes out of the readers behind it, so the input is the array, and not the archive: the first
/// byte says which, the second of what type, the third how the rest is cut into rows.
inline NpzArray replaced(NpzArray array, Bytes input) {
  constexpr std::pair<const char*, std::size_t> kTypes[] = {
      {"", 1}, {"<f4", 4}, {"<f8", 8}, {"<i8", 8}, {"|u1", 1}};
  const auto& [dtype, bytes] = kTypes[input[1] % std::size(kTypes)];
  const Bytes rest = input.subspan(kReplacedHead);
  if (*dtype == '\0') {  // the values alone
    std::memcpy(array.bytes.data(), rest.data(), std::min(rest.size(), array.bytes.size()));
    return array;
  }
  const std::size_t columns = 1 + input[2] % 16U;
  const std::size_t rows = rest.size() / bytes / columns;
  array.dtype = dtype;
  array.shape = {static_cast<std::int64_t>(rows), static_cast<std::int64_t>(columns)};
  if (columns == 1) array.shape.pop_back();
  array.bytes.resize(rows * columns * bytes);
  std::memcpy(array.bytes.data(), rest.data(), array.bytes.size());
  return array;
}

/// The arrays with one replaced.
inline NpzArrays with_one_replaced(NpzArrays arrays, Bytes input) {
  if (input.size() < kReplacedHead) return arrays;
  const std::size_t which = input[0] % arrays.size();
  NpzArray& array = std::next(arrays.begin(), static_cast<std::ptrdiff_t>(which))->second;
  array = replaced(std::move(array), input);
  return arrays;
}

}  // namespace hqslam::fuzz
