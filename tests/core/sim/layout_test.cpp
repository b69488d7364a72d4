#include "layout.h"

#include <doctest/doctest.h>

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
    return std::count_if(layout.blocks.begin(), layout.blocks.end(),
                         [kind](const Block& block) { return block.kind == kind; });
  };
  const Layout town = make_layout(drive_style("town").city, 1);
  CHECK(count(town, BlockKind::kSquare) >= 1);
  CHECK(count(town, BlockKind::kPark) >= 1);
  const Layout hills = make_layout(drive_style("hills").city, 1);
  CHECK(count(hills, BlockKind::kOpenLand) + count(hills, BlockKind::kWalled) >= 15);
}
