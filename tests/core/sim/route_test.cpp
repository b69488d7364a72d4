#include "route.h"

#include <doctest/doctest.h>

using namespace hqslam::sim;

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
        CHECK_FALSE(layout.closed.contains({0, route[k].x(), low}));
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
