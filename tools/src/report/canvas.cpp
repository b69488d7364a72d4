#include "report/canvas.h"

#include <algorithm>
#include <cmath>

#include "report/stroke_font.h"

namespace hqslam::tools {
namespace {

double distance_to_segment(const Eigen::Vector2d& point, const Eigen::Vector2d& from,
                           const Eigen::Vector2d& to) {
  const Eigen::Vector2d along = to - from;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (point - from - t * along).norm();
}

void blend(Rgb& pixel, Rgb color, double cover) {
  for (std::size_t i = 0; i < pixel.size(); ++i) {
    pixel[i] = static_cast<std::uint8_t>(std::lround((1.0 - cover) * pixel[i] + cover * color[i]));
  }
}

/// Pixels of [first, end) that come within `reach` of a..b.
struct Span {
  int first;
  int end;
};
Span span_of(double a, double b, double reach, int first, int end) {
  const double low = std::max(std::floor(std::min(a, b) - reach), static_cast<double>(first));
  const double high = std::min(std::ceil(std::max(a, b) + reach), static_cast<double>(end));
  return low < high ? Span{static_cast<int>(low), static_cast<int>(high)} : Span{0, 0};
}

}  // namespace

Canvas::Canvas(int rows, int columns) {
  image_.rows = rows;
  image_.columns = columns;
  image_.pixels.assign(static_cast<std::size_t>(rows) * columns, Rgb{255, 255, 255});
}

void Canvas::draw_segment(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double width,
                          Rgb color, const PixelBox& clip) {
  const double reach = 0.5 * width + 1.0;
  const Span columns = span_of(from.x(), to.x(), reach, clip.left, clip.left + clip.columns);
  const Span rows = span_of(from.y(), to.y(), reach, clip.top, clip.top + clip.rows);
  for (int row = rows.first; row < rows.end; ++row) {
    for (int column = columns.first; column < columns.end; ++column) {
      const double distance = distance_to_segment({column + 0.5, row + 0.5}, from, to);
      // The share of a pixel that a line of this width covers, to a good approximation.
      const double cover = std::clamp(0.5 * width + 0.5 - distance, 0.0, 1.0);
      blend(image_.pixels[static_cast<std::size_t>(row) * image_.columns + column], color, cover);
    }
  }
}

void Canvas::draw_line(const std::vector<Eigen::Vector2d>& points, double width, Rgb color,
                       const PixelBox& clip) {
  if (points.size() == 1) draw_segment(points[0], points[0], width, color, clip);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    draw_segment(points[i], points[i + 1], width, color, clip);
  }
}

void Canvas::fill(const PixelBox& box, Rgb color) {
  for (int row = box.top; row < box.top + box.rows; ++row) {
    for (int column = box.left; column < box.left + box.columns; ++column) {
      image_.pixels[static_cast<std::size_t>(row) * image_.columns + column] = color;
    }
  }
}

void Canvas::draw_text(std::string_view text, const Eigen::Vector2d& at, double height, Rgb color) {
  const double unit = height / kGlyphHeight;
  double left = at.x();
  for (const char character : text) {
    const Glyph letter = glyph(character);
    for (const std::vector<Eigen::Vector2d>& stroke : letter.strokes) {
      std::vector<Eigen::Vector2d> points;
      for (const Eigen::Vector2d& point : stroke) {
        points.emplace_back(left + unit * point.x(), at.y() - unit * point.y());
      }
      draw_line(points, 0.75 * unit, color, whole());
    }
    left += unit * letter.advance;
  }
}

double text_width(std::string_view text, double height) {
  double width = 0.0;
  for (const char character : text) width += glyph(character).advance;
  return width * height / kGlyphHeight;
}

}  // namespace hqslam::tools
