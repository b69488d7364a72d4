#include "lzf.h"

namespace hqslam {

// A stream is a row of commands that begin with a control byte c:
//   c < 32        c + 1 literal bytes follow
//   c >= 32       repeat: length (c >> 5) + 2, where 7 in c >> 5 adds the next byte to the length;
//                 distance back (c & 31) * 256 + the byte after + 1. It may overlap its own output.
std::optional<std::string> lzf_decompressed(std::string_view stream, std::size_t size) {
  if (size / kLzfMaxRatio > stream.size()) return std::nullopt;
  std::string result;
  result.reserve(size);
  std::size_t at = 0;
  const auto next_byte = [&]() { return static_cast<unsigned char>(stream[at++]); };
  while (at < stream.size()) {
    const std::size_t control = next_byte();
    if (control < 32) {
      const std::size_t length = control + 1;
      if (length > stream.size() - at || length > size - result.size()) return std::nullopt;
      result.append(stream.substr(at, length));
      at += length;
      continue;
    }
    std::size_t length = (control >> 5) + 2;
    if (stream.size() - at < (length == 9 ? 2U : 1U)) return std::nullopt;
    if (length == 9) length += next_byte();
    const std::size_t distance = (control & 31) * 256 + next_byte() + 1;
    if (distance > result.size() || length > size - result.size()) return std::nullopt;
    for (std::size_t i = 0; i < length; ++i) result.push_back(result[result.size() - distance]);
  }
  if (result.size() != size) return std::nullopt;
  return result;
}

}  // namespace hqslam
