#include "table/error_map.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "error_message.h"
#include "run/trajectory_plot.h"

namespace hqslam::tools {
namespace {

/// A straight drive of 100 m to the right, once per largest error.
ErrorMap example_map(const std::vector<double>& largest_errors_m) {
  ErrorMap map;
  for (int i = 0; i <= 100; ++i) map.reference_m.emplace_back(i, 0.0);
  for (const double largest_m : largest_errors_m) {
    ErrorPanel panel{"panel", largest_m, map.reference_m, {}};
    panel.error_m.assign(101, 0.0);
    panel.error_m[50] = largest_m;
    map.panels.push_back(panel);
  }
  return map;
}

std::int64_t pixels_of(const RgbImage& image, const std::array<std::uint8_t, 3>& color) {
  return std::count(image.pixels.begin(), image.pixels.end(), color);
}

}  // namespace

TEST_CASE("the scale ends at the largest error of all panels") {
  const ErrorScale scale = error_scale(example_map({0.2, 0.5, 0.3}));
  CHECK(scale.top_m == 0.5);
  CHECK_FALSE(scale.clipped);
  CHECK(top_text(scale) == "0.50 m");
}

TEST_CASE("one trajectory that leaves the map does not take the colours from the others") {
  const ErrorScale scale = error_scale(example_map({6717.0, 0.5, 0.3}));
  CHECK(scale.top_m == doctest::Approx(1.5));
  CHECK(scale.clipped);
  CHECK(top_text(scale) == "1.50 m or more");
}

TEST_CASE("without an error there is still a scale and a picture") {
  CHECK(error_scale({}).top_m > 0.0);
  const ErrorMap exact = example_map({0.0});
  CHECK(pixels_of(panel_image(exact, 0, error_scale(exact)), error_rgb(0.0)) > 100);
}

TEST_CASE("a pose has the colour of its error: the last one of the scale, in every panel") {
  ErrorMap map = example_map({1.0, 1.0});
  map.panels[0].error_m.assign(101, 1.0);
  map.panels[1].error_m.assign(101, 0.5);
  const ErrorScale scale = error_scale(map);
  CHECK(pixels_of(panel_image(map, 0, scale), error_rgb(1.0)) > 100);
  CHECK(pixels_of(panel_image(map, 1, scale), error_rgb(0.5)) > 100);
  CHECK(pixels_of(panel_image(map, 1, scale), error_rgb(1.0)) == 0);
}

TEST_CASE("a trajectory far off is cut at its panel's edge") {
  ErrorMap map = example_map({1.0, 1.0});
  const ErrorScale scale = error_scale(map);
  const RgbImage before = panel_image(map, 1, scale);
  for (Eigen::Vector2d& point_m : map.panels[0].path_m) point_m += Eigen::Vector2d(1e5, 1e5);
  CHECK(pixels_of(panel_image(map, 0, scale), error_rgb(0.0)) == 0);
  CHECK(panel_image(map, 1, scale).pixels == before.pixels);
}

TEST_CASE("the picture holds all panels and grows with their number") {
  const RgbImage two = error_map_image(example_map({1.0, 0.5}), "drive");
  const RgbImage seven = error_map_image(example_map({1.0, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5}), "drive");
  CHECK(two.pixels.size() == static_cast<std::size_t>(two.rows) * two.columns);
  CHECK(seven.columns > two.columns);
  CHECK(seven.rows > two.rows);
  CHECK(test::one_line_with(test::error_message([] { error_map_image({}, "drive"); }),
                            "expected at least one"));
}

}  // namespace hqslam::tools
