#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hqslam/core/point_fields.h"

namespace hqslam {

/// A number that every point has, and its place in memory.
struct PointColumn {
  const char* name;
  StoredNumber stored;
  const void* first;       ///< of the first point
  std::size_t step_bytes;  ///< to the next one
};

/// Writes points as write_cloud does; columns: x y z (float32) first, then any others. note: a
/// comment in the header of a .pcd or .ply file; "": none. Throws Error.
void write_points(const std::vector<PointColumn>& columns, std::size_t points,
                  const std::string& path, const std::string& note = "");

}  // namespace hqslam
