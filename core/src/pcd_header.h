#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hqslam {

/// One field of a .pcd file: `count` numbers of `size` bytes per point.
struct PcdField {
  std::string name;
  char type = 'F';  ///< F float, I signed, U unsigned
  std::size_t size_bytes = 4;
  std::size_t count = 1;
  std::size_t offset_bytes = 0;  ///< within a point of a binary file
  std::size_t first_number = 0;  ///< within a line of an ascii file
};

enum class PcdData { kAscii, kBinary, kBinaryCompressed };

struct PcdHeader {
  std::vector<PcdField> fields;
  std::size_t points = 0;
  std::size_t point_bytes = 0;
  std::size_t point_numbers = 0;
  PcdData data = PcdData::kAscii;
  std::size_t data_offset_bytes = 0;
};

/// Parses the header at the beginning of a .pcd file. Throws Error.
PcdHeader parse_pcd_header(std::string_view file, const std::string& path);

}  // namespace hqslam
