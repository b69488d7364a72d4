#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "hqslam/core/point_fields.h"

namespace hqslam {

/// A .txt or .csv file: a point per line, numbers separated by spaces, tabs, commas or semicolons.
/// A first line may name the columns (x y z, ring or channel, t or time ...); without one they are
/// x y z intensity ring t, of which the first three are required. Lines that begin with # or // are
/// skipped. Throws Error with the line.
RawPoints read_text_points(const std::string& path);

/// A .ply file, ascii or binary_little_endian, whose first element is `vertex`; properties x y z,
/// ring or channel, t or time ..., of any number type, in any order. Throws Error.
RawPoints read_ply_points(const std::string& path);

/// A .pcd file, as read_cloud describes it. Throws Error.
RawPoints read_pcd_points(const std::string& path);

/// The bytes of an LZF stream, decompressed; nothing if the stream is damaged or they are not
/// exactly `size`. Source of the format: liblzf (Marc Lehmann).
std::optional<std::string> lzf_decompressed(std::string_view stream, std::size_t size);

}  // namespace hqslam
