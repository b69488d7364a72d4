#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace hqslam {

/// How a file stores a number: F float of 4 or 8 bytes, I signed or U unsigned of 1, 2, 4 or 8.
struct StoredNumber {
  char type = 'F';
  std::size_t bytes = 4;
};

template <typename T>
double number_at(const char* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

inline double number_at(const char* bytes, StoredNumber stored) {
  if (stored.type == 'F') {
    return stored.bytes == 4 ? number_at<float>(bytes) : number_at<double>(bytes);
  }
  const bool is_signed = stored.type == 'I';
  switch (stored.bytes) {
    case 1:
      return is_signed ? number_at<std::int8_t>(bytes) : number_at<std::uint8_t>(bytes);
    case 2:
      return is_signed ? number_at<std::int16_t>(bytes) : number_at<std::uint16_t>(bytes);
    case 4:
      return is_signed ? number_at<std::int32_t>(bytes) : number_at<std::uint32_t>(bytes);
    default:
      return is_signed ? number_at<std::int64_t>(bytes) : number_at<std::uint64_t>(bytes);
  }
}

}  // namespace hqslam
