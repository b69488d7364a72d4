#include "report/canvas.h"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "report/stroke_font.h"

namespace hqslam::tools {
namespace {

constexpr Rgb kWhite = {255, 255, 255};
constexpr Rgb kRed = {255, 0, 0};

Rgb at(const Canvas& canvas, int row, int column) {
  return canvas.image().pixels[static_cast<std::size_t>(row) * canvas.image().columns + column];
}

}  // namespace

TEST_CASE("a line of width 1 through the centres of a row of pixels colours just those") {
  Canvas canvas(5, 10);
  canvas.draw_line({{2.5, 2.5}, {7.5, 2.5}}, 1.0, kRed, canvas.whole());
  for (int column = 0; column < 10; ++column) {
    CHECK(at(canvas, 2, column) == (column >= 2 && column <= 7 ? kRed : kWhite));
    CHECK(at(canvas, 1, column) == kWhite);
  }
}

TEST_CASE("a line between two rows of pixels colours both by half") {
  Canvas canvas(4, 4);
  canvas.draw_line({{-5.0, 2.0}, {9.0, 2.0}}, 1.0, kRed, canvas.whole());
  CHECK(at(canvas, 1, 1)[1] == doctest::Approx(127).epsilon(0.01));
  CHECK(at(canvas, 2, 1)[1] == doctest::Approx(127).epsilon(0.01));
  CHECK(at(canvas, 0, 1) == kWhite);
}

TEST_CASE("nothing is drawn outside the clip, and nothing outside the image") {
  Canvas canvas(4, 8);
  canvas.draw_line({{-1e7, 2.5}, {1e7, 2.5}}, 3.0, kRed, {2, 1, 3, 2});
  CHECK(at(canvas, 2, 1) == kWhite);
  CHECK(at(canvas, 2, 2) == kRed);
  CHECK(at(canvas, 2, 4) == kRed);
  CHECK(at(canvas, 2, 5) == kWhite);
  CHECK(at(canvas, 3, 3) == kWhite);
}

TEST_CASE("every letter and digit has strokes of its own, what is missing is a box") {
  std::set<std::string> shapes;
  const std::string characters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz123456789-+.,:/()=%_";
  for (const char character : characters) {
    std::string shape;
    for (const auto& stroke : glyph(character).strokes) {
      for (const Eigen::Vector2d& point : stroke) {
        shape += std::to_string(point.x()) + " " + std::to_string(point.y()) + ",";
      }
      shape += ";";
    }
    CAPTURE(character);
    CHECK(shapes.insert(shape).second);
  }
  CHECK(glyph('\x01').strokes.size() == 1);
  CHECK(glyph('\x01').strokes[0].size() == 5);
  CHECK(glyph(' ').strokes.empty());
}

TEST_CASE("a narrow letter takes little room and begins at once") {
  CHECK(glyph('i').strokes[0][0].x() == 0.0);
  CHECK(glyph('1').strokes[0][0].x() == 0.0);
  CHECK(glyph('i').advance < 0.5 * glyph('m').advance);
}

TEST_CASE("text stays within the width that is said") {
  const double width = text_width("LiDAR-16, 0.42 m", 12.0);
  Canvas canvas(30, static_cast<int>(width) + 30);
  canvas.draw_text("LiDAR-16, 0.42 m", {10.0, 20.0}, 12.0, kRed);
  int last = 0;
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < canvas.image().columns; ++column) {
      if (at(canvas, row, column) != kWhite) last = std::max(last, column);
    }
  }
  CHECK(last > 10.0 + 0.9 * width);
  CHECK(last < 10.0 + width);
}

}  // namespace hqslam::tools
