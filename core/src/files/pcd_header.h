#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hqslam/core/point_fields.h"

namespace hqslam {

enum class PcdData { kAscii, kBinary, kBinaryCompressed };

struct PcdHeader {
  std::vector<PointField> fields;
  std::size_t points = 0;
  std::size_t point_bytes = 0;
  std::size_t point_numbers = 0;
  PcdData data = PcdData::kAscii;
  std::size_t data_offset_bytes = 0;
};

/// The bytes of an LZF stream, decompressed; nothing if the stream is damaged or they are not
/// exactly `size`. Source of the format: liblzf (Marc Lehmann).
std::optional<std::string> lzf_decompressed(std::string_view stream, std::size_t size);

/// Parses the header at the beginning of a .pcd file. Throws Error.
PcdHeader parse_pcd_header(std::string_view file, const std::string& path);

}  // namespace hqslam
