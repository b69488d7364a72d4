#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "hqslam/core/png.h"

namespace hqslam::tools {

using Rgb = std::array<std::uint8_t, 3>;

/// A part of an image in pixels: columns to the right, rows downwards.
struct PixelBox {
  int left = 0;
  int top = 0;
  int columns = 0;
  int rows = 0;
};

/// A white image to draw on, with smooth edges.
class Canvas {
 public:
  Canvas(int rows, int columns);
  const RgbImage& image() const { return image_; }

  /// A line through points (x to the right, y downwards, in pixels; pixel (0, 0) has its centre at
  /// 0.5, 0.5) with round ends; nothing is drawn outside `clip`. One point is a dot.
  void draw_line(const std::vector<Eigen::Vector2d>& points, double width, Rgb color,
                 const PixelBox& clip);
  void fill(const PixelBox& box, Rgb color);
  /// One line of text, its lower left corner at `at`, capitals `height` pixels high.
  void draw_text(std::string_view text, const Eigen::Vector2d& at, double height, Rgb color);
  PixelBox whole() const { return {0, 0, image_.columns, image_.rows}; }

 private:
  void draw_segment(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width, Rgb color,
                    const PixelBox& clip);
  RgbImage image_;
};

/// How wide draw_text's text is.
double text_width(std::string_view text, double height);

}  // namespace hqslam::tools
