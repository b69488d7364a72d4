#include "npy_header_bytes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace hqslam {

std::string npy_shape_text(const std::vector<std::int64_t>& shape) {
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

std::string npy_header_bytes(const std::string& dtype, const std::vector<std::int64_t>& shape,
                             std::size_t least_bytes) {
  constexpr std::size_t kPreamble = 10;
  constexpr std::size_t kAlignment = 64;
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", dtype,
                                 npy_shape_text(shape));
  const std::size_t needed = std::max(kPreamble + text.size() + 1, least_bytes);
  text.resize((needed + kAlignment - 1) / kAlignment * kAlignment - kPreamble - 1, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() & 0xFF);
  header += static_cast<char>(text.size() >> 8);
  return header + text;
}

}  // namespace hqslam
