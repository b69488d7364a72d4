#include "laboratory/table/error_map.h"

#include <doctest/doctest.h>

#include <string>

#include "error_message.h"
#include "report/error_color.h"

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

bool has_color(const std::string& svg, double share) {
  return svg.find(error_color_of_class(error_color_class(share))) != std::string::npos;
}

int count(const std::string& text, const std::string& part) {
  int found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
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
  CHECK(has_color(panel_svg(exact, 0, error_scale(exact)), 0.0));
}

TEST_CASE("a pose has the colour of its error: the last one of the scale, in every panel") {
  ErrorMap map = example_map({1.0, 1.0});
  map.panels[0].error_m.assign(101, 1.0);
  map.panels[1].error_m.assign(101, 0.5);
  const ErrorScale scale = error_scale(map);
  CHECK(has_color(panel_svg(map, 0, scale), 1.0));
  CHECK(has_color(panel_svg(map, 1, scale), 0.5));
  CHECK_FALSE(has_color(panel_svg(map, 1, scale), 1.0));
}

TEST_CASE("a trajectory is drawn to scale, in steps that can be seen, with a ring at its start") {
  // 100 m with margins of 12 m: 480 pixels for 124 m, the start at 46.5.
  ErrorMap map = example_map({1.0});
  const std::string svg = panel_svg(map, 0, error_scale(map));
  CHECK(svg.find("<circle cx=\"46.5\"") != std::string::npos);
  CHECK(svg.find("M46.5 ") != std::string::npos);
  CHECK(svg.find("L433.5 ") != std::string::npos);
  for (ErrorPanel& panel : map.panels) {
    panel.path_m.clear();
    for (int i = 0; i <= 10000; ++i) panel.path_m.emplace_back(0.01 * i, 0.0);
    panel.error_m.assign(panel.path_m.size(), 0.0);
  }
  CHECK(panel_svg(map, 0, error_scale(map)).size() < 2 * svg.size());
}

TEST_CASE("the picture holds all panels with their names and grows with their number") {
  ErrorMap map = example_map({1.0, 0.5});
  map.panels[1].title = "a < b";
  const std::string two = error_map_svg(map, "drive & drive");
  CHECK(count(two, "<svg") == 3);
  CHECK(two.find("a &lt; b") != std::string::npos);
  CHECK(two.find("drive &amp; drive") != std::string::npos);
  CHECK(two.find("width=\"1020\"") != std::string::npos);
  const std::string seven =
      error_map_svg(example_map({1.0, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5}), "drive");
  CHECK(count(seven, "<svg") == 8);
  CHECK(seven.find("width=\"2020\"") != std::string::npos);
  CHECK(test::one_line_with(test::error_message([] { error_map_svg({}, "drive"); }),
                            "expected at least one"));
}

}  // namespace hqslam::tools
