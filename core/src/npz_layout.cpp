#include "npz_layout.h"

#include <algorithm>

namespace hqslam {

std::optional<std::int64_t> npz_element_bytes(const std::string& dtype) {
  if (dtype == "<f8" || dtype == "<i8") return 8;
  if (dtype == "<f4" || dtype == "<i4") return 4;
  if (dtype == "|u1" || dtype == "|i1" || dtype == "|b1") return 1;
  return std::nullopt;
}

std::optional<std::int64_t> npz_element_count(const std::vector<std::int64_t>& shape) {
  constexpr std::int64_t kMaxElements = std::int64_t{1} << 59;
  if (std::any_of(shape.begin(), shape.end(), [](std::int64_t size) { return size < 0; })) {
    return std::nullopt;
  }
  // A size of 0 anywhere makes the array empty, however large the others are.
  if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return 0;
  std::int64_t count = 1;
  for (const std::int64_t size : shape) {
    if (size > kMaxElements / count) return std::nullopt;
    count *= size;
  }
  return count;
}

}  // namespace hqslam
