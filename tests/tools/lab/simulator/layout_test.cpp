#include "layout.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "random.h"

using namespace hqslam::sim;

TEST_CASE("blocks overlap neither each other nor an open street") {
  for (const char* name : {"block", "town", "hills"}) {
    const Layout layout = make_layout(drive_style(name).city, 4);
    for (std::size_t a = 0; a < layout.blocks.size(); ++a) {
      for (std::size_t b = a + 1; b < layout.blocks.size(); ++b) {
        CHECK(layout.blocks[a].sheet_m.intersection(layout.blocks[b].sheet_m).isEmpty());
      }
    }
    // Blocks and streets together cover the whole city once; a closed stretch belongs to a block.
    double covered_m2 = 0.0;
    for (const Block& block : layout.blocks) covered_m2 += block.sheet_m.volume();
    std::array<double, 2> free_m = {layout.rim_m.sizes().x(), layout.rim_m.sizes().y()};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      for (const Street& street : layout.streets[axis]) free_m[axis] -= 2.0 * street.half_width_m;
    }
    double closed_m2 = 0.0;
    for (const Stretch& stretch : layout.closed) {
      const auto& across = layout.streets[1];
      const Street& low = across[static_cast<std::size_t>(stretch.from_crossing)];
      const Street& high = across[static_cast<std::size_t>(stretch.from_crossing) + 1];
      closed_m2 += 2.0 * layout.streets[0][static_cast<std::size_t>(stretch.street)].half_width_m *
                   (high.position_m - high.half_width_m - low.position_m - low.half_width_m);
    }
    CHECK(covered_m2 == doctest::Approx(free_m[0] * free_m[1] + closed_m2));
  }
}

TEST_CASE("the sheet is bent without folds and streets keep nearly their width") {
  const Layout layout = make_layout(drive_style("hills").city, 2);
  Random random(8);
  for (int k = 0; k < 500; ++k) {
    const Eigen::Vector2d at =
        layout.rim_m.min() +
        Eigen::Vector2d(random.uniform(), random.uniform()).cwiseProduct(layout.rim_m.sizes());
    Eigen::Matrix2d jacobian;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = 0.01 * Eigen::Vector2d::Unit(axis);
      jacobian.col(axis) = (layout.plane(at + step) - layout.plane(at - step)) / 0.02;
    }
    CHECK(jacobian.determinant() > 0.5);
    CHECK(jacobian.determinant() < 1.6);
  }
}

TEST_CASE("town has squares and parks, hills has stretches poor in features") {
  const auto count = [](const Layout& layout, BlockKind kind) {
    return std::ranges::count_if(layout.blocks,
                                 [kind](const Block& block) { return block.kind == kind; });
  };
  const Layout town = make_layout(drive_style("town").city, 1);
  CHECK(count(town, BlockKind::kSquare) >= 1);
  CHECK(count(town, BlockKind::kPark) >= 1);
  const Layout hills = make_layout(drive_style("hills").city, 1);
  CHECK(count(hills, BlockKind::kOpenLand) + count(hills, BlockKind::kWalled) >= 15);
}

TEST_CASE("the slope of the terrain is the derivative of its height and keeps the bound") {
  const Terrain terrain(3, 0.2);
  Random random(1);
  constexpr double kStep_m = 1e-3;
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector2d at(random.uniform(-800.0, 800.0), random.uniform(-800.0, 800.0));
    const Eigen::Vector2d slope = terrain.slope(at);
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d step = kStep_m * Eigen::Vector2d::Unit(axis);
      const double numeric =
          (terrain.height_m(at + step) - terrain.height_m(at - step)) / (2.0 * kStep_m);
      CHECK(std::abs(slope[axis] - numeric) < 1e-7);
    }
    CHECK(slope.norm() <= 0.2);
  }
}

TEST_CASE("what stands on the ground touches it ahead and to the left, whichever way it looks") {
  const Terrain terrain(7, 0.3);
  for (int k = 0; k < 12; ++k) {
    const Eigen::Vector2d at(40.0 * k - 200.0, 25.0 * k - 100.0);
    const Eigen::Isometry3d frame = terrain.frame(at, 0.5 * k);
    for (const Eigen::Vector3d& step :
         {Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(0.0, 1.0, 0.0)}) {
      const Eigen::Vector3d point = frame * step;
      CHECK(std::abs(point.z() - terrain.height_m(point.head<2>())) < 0.03);
    }
    const Eigen::Vector3d forward = frame.linear().col(0);
    CHECK(std::remainder(std::atan2(forward.y(), forward.x()) - 0.5 * k, 2.0 * std::numbers::pi) ==
          doctest::Approx(0.0));
  }
}
