#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
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

/// The dtypes an NpzArray may have, for messages.
constexpr const char* kNpzDtypes = "<f4, <f8, <i8, <i4, |u1, |i1 or |b1";

/// Bytes of one element; none for another dtype than kNpzDtypes.
std::optional<std::int64_t> npz_element_bytes(const std::string& dtype);

/// The product of the shape's sizes; none if one is negative or the product exceeds 2^59, so that
/// the number of bytes does not overflow.
std::optional<std::int64_t> npz_element_count(const std::vector<std::int64_t>& shape);

}  // namespace hqslam
