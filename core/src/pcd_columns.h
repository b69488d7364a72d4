#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "pcd_header.h"

namespace hqslam {

/// One number per point of a .pcd file.
struct PcdColumn {
  const char* first = nullptr;
  std::size_t stride_bytes = 0;
  char type = 'F';
  std::size_t size_bytes = 4;

  double at(std::size_t point) const;
};

/// The data of a .pcd file, whichever way it is stored.
class PcdColumns {
 public:
  /// `file` must outlive the object. Throws Error if the data do not fit the header.
  PcdColumns(std::string_view file, const PcdHeader& header, const std::string& path);

  /// The first number of this field. Throws Error if it has none.
  PcdColumn column(const PcdField& field) const;

 private:
  void read_ascii(std::string_view data);
  void read_binary(std::string_view data);
  void read_compressed(std::string_view data);

  const PcdHeader& header_;
  const std::string& path_;
  std::vector<double> numbers_;   ///< ascii: points x point_numbers
  std::string decompressed_;      ///< binary_compressed: one field after the other
  const char* points_ = nullptr;  ///< binary: one point after the other
};

}  // namespace hqslam
