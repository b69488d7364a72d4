#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace hqslam {

/// As Python writes a tuple: "()", "(3,)", "(2, 3)".
std::string npy_shape_text(const std::vector<std::int64_t>& shape);

/// The preamble and dictionary of an .npy file of version 1.0 in C order, padded with spaces to a
/// multiple of 64 bytes, `least_bytes` or more. At most 32 sizes in the shape.
/// Source: numpy.lib.format.
std::string npy_header_bytes(const std::string& dtype, const std::vector<std::int64_t>& shape,
                             std::size_t least_bytes);

}  // namespace hqslam
