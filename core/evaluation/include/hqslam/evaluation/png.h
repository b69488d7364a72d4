#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"

namespace hqslam {

using Rgb = std::array<std::uint8_t, 3>;

/// The colour between the stops: share 0 is the first, 1 the last.
Rgb color_between(std::span<const Rgb> stops, double share);

struct RgbImage {
  int rows = 0;
  int columns = 0;
  std::vector<Rgb> pixels;  ///< row-major
};

/// Throws Error if the image is empty or the file cannot be written.
void write_png(const RgbImage& image, const std::string& path);
/// The file's bytes, for embedding in a page.
std::vector<std::uint8_t> encode_png(const RgbImage& image);

/// Colours are logarithmic in range, from bright (1 m and less) to dark blue (max_range_m and
/// more); no return is black. Throws Error unless max_range_m is more than 1 m.
RgbImage color_by_range(const RangeImage& image, double max_range_m);

}  // namespace hqslam
