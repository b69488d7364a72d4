#include "hqslam/evaluation/png.h"

#include <png.h>

#include <algorithm>
#include <cmath>

#include "hqslam/core/error.h"
#include "hqslam/core/whole_file.h"

namespace hqslam {

namespace {

/// From near to far.
constexpr std::array<Rgb, 5> kColors = {
    {{255, 250, 205}, {250, 190, 90}, {95, 185, 150}, {45, 100, 170}, {15, 25, 90}}};
constexpr double kNearest_m = 1.0;

}  // namespace

Rgb color_between(std::span<const Rgb> stops, double share) {
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(position), stops.size() - 2);
  const double weight = position - static_cast<double>(below);
  Rgb color{};
  for (std::size_t i = 0; i < color.size(); ++i) {
    color[i] = static_cast<std::uint8_t>(
        std::lround((1.0 - weight) * stops[below][i] + weight * stops[below + 1][i]));
  }
  return color;
}

std::vector<std::uint8_t> encode_png(const RgbImage& image) {
  constexpr int kMaxSide = 65536;
  const bool fits = image.rows >= 1 && image.columns >= 1 && image.rows <= kMaxSide &&
                    image.columns <= kMaxSide &&
                    image.pixels.size() == static_cast<std::size_t>(image.rows) * image.columns;
  if (!fits) {
    throw Error("expected an image of 1 to {} rows and columns, found {} x {} with {} pixels",
                kMaxSide, image.rows, image.columns, image.pixels.size());
  }
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.columns);
  png.height = static_cast<png_uint_32>(image.rows);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<std::uint8_t> bytes(size);
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.pixels.data(), 0, nullptr) ==
      0) {
    throw Error("the image of {} x {} pixels could not be encoded: {}", image.rows, image.columns,
                png.message);
  }
  bytes.resize(size);
  return bytes;
}

void write_png(const RgbImage& image, const std::string& path) {
  const std::vector<std::uint8_t> bytes = encode_png(image);
  write_whole_file(path, std::string(bytes.begin(), bytes.end()));
}

RgbImage color_by_range(const RangeImage& image, double max_range_m) {
  if (!(max_range_m > kNearest_m) || !std::isfinite(max_range_m)) {
    throw Error("max_range_m: expected more than {} m, found {}", kNearest_m, max_range_m);
  }
  RgbImage result;
  result.rows = image.rows;
  result.columns = image.columns;
  result.pixels.reserve(image.range_m.size());
  for (const float range_m : image.range_m) {
    const bool has_return = range_m > 0.0F;
    result.pixels.push_back(has_return
                                ? color_between(kColors, std::log(range_m / kNearest_m) /
                                                             std::log(max_range_m / kNearest_m))
                                : Rgb{0, 0, 0});
  }
  return result;
}

}  // namespace hqslam
