#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace hqslam::recordings {

using Bytes = std::span<const std::uint8_t>;

static_assert(std::endian::native == std::endian::little, "sensors write little-endian numbers");

/// The little-endian number that starts at this byte; the caller has checked that it is there.
template <typename T>
T little_endian(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

template <typename T>
T little_endian(Bytes bytes, std::size_t at) {
  return little_endian<T>(bytes.data() + at);
}

/// A big-endian 16-bit number, as the headers of the internet protocol have them.
inline std::uint16_t big_endian_16(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

}  // namespace hqslam::recordings
