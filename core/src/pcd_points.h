#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "pcd_header.h"
#include "words.h"

namespace hqslam {

/// The points of a .pcd file, whichever way they are stored.
class PcdPoints {
 public:
  /// `file`, `header` and `path` must outlive the object. Throws Error if the data do not fit the
  /// header.
  PcdPoints(std::string_view file, const PcdHeader& header, const std::string& path);

  /// To point 0 first, then to point 1 and so on. Throws Error if a word of a text is no number.
  void go_to(std::size_t point);
  /// That point's first number of a field.
  double value(const PointField& field) const;

 private:
  void read_binary(std::string_view data);
  void read_compressed(std::string_view data);

  const PcdHeader& header_;
  const std::string& path_;
  std::size_t point_ = 0;
  std::optional<AsciiPoints> ascii_;
  const double* numbers_ = nullptr;  ///< ascii: those of the point
  const char* points_ = nullptr;     ///< binary: one point after the other
  std::string decompressed_;         ///< binary_compressed: one field after the other
};

}  // namespace hqslam
