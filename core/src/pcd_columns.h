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

  /// To be called before the columns are asked for point 0, then for point 1 and so on: of a text
  /// only one point is kept as numbers, since all would take many times its size. Throws Error if a
  /// word of it is no number.
  void read_point(std::size_t point);

 private:
  void check_ascii(std::string_view data);
  void read_binary(std::string_view data);
  void read_compressed(std::string_view data);

  const PcdHeader& header_;
  const std::string& path_;
  std::string_view rest_;         ///< ascii: what has not been read
  std::vector<double> numbers_;   ///< ascii: those of one point
  std::string decompressed_;      ///< binary_compressed: one field after the other
  const char* points_ = nullptr;  ///< binary: one point after the other
};

}  // namespace hqslam
