#include "route.h"

#include <doctest/doctest.h>

using namespace hqslam::sim;

namespace {

/// A flat sheet, unbent, with the given style's streets.
Layout flat_layout() {
  CityStyle style = drive_style("town").city;
  style.bend = 0.0;
  style.slope_bound = 0.0;
  style.closed_street_share = 0.0;
  return make_layout(style, 3);
}

}  // namespace

TEST_CASE("a route follows open streets and never turns back on the spot") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const DriveStyle style = drive_style(seed % 2 == 0 ? "town" : "hills");
    const Layout layout = make_layout(style.city, seed);
    const auto route = make_route(layout, style.driver, seed, 8000.0);
    for (std::size_t k = 0; k + 1 < route.size(); ++k) {
      const Eigen::Vector2i step = route[k + 1] - route[k];
      REQUIRE(step.cwiseAbs().sum() == 1);
      REQUIRE((route[k].array() >= 0).all());
      REQUIRE((route[k].array() < style.city.grid[0].streets).all());
      if (k > 0) REQUIRE(route[k + 1] != route[k - 1]);
      if (step.x() == 0) {
        const int low = std::min(route[k].y(), route[k + 1].y());
        CHECK_FALSE(layout.closed.contains({route[k].x(), low}));
      }
    }
  }
}

TEST_CASE("a longer route begins with the shorter one") {
  const DriveStyle style = drive_style("town");
  const Layout layout = make_layout(style.city, 1);
  const auto shorter = make_route(layout, style.driver, 7, 1000.0);
  const auto longer = make_route(layout, style.driver, 7, 9000.0);
  REQUIRE(longer.size() > shorter.size());
  CHECK(std::equal(shorter.begin(), shorter.end(), longer.begin()));
}

TEST_CASE("the lane keeps to the right, never crosses a kerb and has no gap") {
  const Layout layout = flat_layout();
  const DriverStyle style = drive_style("town").driver;
  const std::vector<Crossing> route = {{1, 1}, {2, 1}, {3, 1}, {3, 2}, {4, 2}, {4, 1}, {4, 0}};
  const auto lane = lane_along(layout, route, style, 1);
  REQUIRE(lane.size() > 200);
  const Eigen::Vector2d first_step = lane[1].plane_m - lane[0].plane_m;
  CHECK(first_step.x() > 0.0);
  const Street& street = layout.streets[1][1];
  // Driving along +x, right is -y.
  CHECK(lane[0].plane_m.y() == doctest::Approx(street.position_m - street.lane_offset_m));
  for (std::size_t k = 0; k + 1 < lane.size(); ++k) {
    CHECK((lane[k + 1].plane_m - lane[k].plane_m).norm() < 0.51);
    CHECK(lane[k].speed_limit_mps >= style.min_limit_mps);
    CHECK(lane[k].speed_limit_mps <= style.max_limit_mps);
    for (const Block& block : layout.blocks) {
      // The sharp corner of a block's rectangle is cut by its rounded kerb.
      const Eigen::Vector2d at = lane[k].plane_m;
      if (!block.sheet_m.contains(at)) continue;
      const Eigen::Vector2d corner = ((at - block.sheet_m.center()).array() > 0.0)
                                         .select(block.sheet_m.max(), block.sheet_m.min());
      const Eigen::Vector2d from_arc = (at - corner).cwiseAbs().array() - kCornerRadius_m;
      CHECK((from_arc.array() < 0.0).all());
      CHECK(from_arc.norm() > kCornerRadius_m);
    }
  }
}

TEST_CASE("stops follow the style: everywhere or nowhere") {
  const Layout layout = flat_layout();
  DriverStyle style = drive_style("town").driver;
  const std::vector<Crossing> route = {{1, 1}, {2, 1}, {3, 1}, {3, 2}, {4, 2}, {5, 2}};
  const auto stops = [&](double share) {
    style.stop_share = share;
    const auto lane = lane_along(layout, route, style, 1);
    return std::ranges::count_if(lane, [](const LanePoint& point) { return point.stop_s > 0.0; });
  };
  CHECK(stops(0.0) == 0);
  CHECK(stops(1.0) == 4);
}
