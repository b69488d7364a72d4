#include <algorithm>
#include <optional>

#include "block_contents.h"
#include "furniture.h"

namespace hqslam::sim {

namespace {

/// Clear of crossings, where whoever drives must see.
constexpr double kCornerRoom_m = 14.0;

/// Stretches of hedge or fence along a road, with nothing between them.
void add_edge(City& city, const BlockSide& side, Random& random) {
  double from_m = kCornerRoom_m;
  while (from_m < side.length_m - kCornerRoom_m - 5.0) {
    const double to_m =
        std::min(side.length_m - kCornerRoom_m, from_m + random.uniform(25.0, 90.0));
    const double kind = random.uniform();
    if (kind < 0.1) {
      const double height_m = random.uniform(1.0, 2.2);
      add_hedge(city, side.at(from_m, 2.5), side.at(to_m, 2.5), height_m, random);
    } else if (kind < 0.3) {
      add_rail_fence(city, side.at(from_m, 2.0), side.at(to_m, 2.0));
    }
    from_m = to_m;
  }
}

/// Telegraph poles with a wire.
void add_poles(City& city, const BlockSide& side, Random& random) {
  const double spacing_m = random.uniform(42.0, 60.0);
  std::optional<Eigen::Vector3d> last_top_m;
  for (double along_m = 12.0; along_m < side.length_m - 8.0; along_m += spacing_m) {
    const Eigen::Vector2d at = side.at(along_m, 3.6);
    const Eigen::Vector3d top_m = city.layout.ground(at, 7.5);
    add_column(city.fixed, city.layout.ground(at, -0.3), top_m, 0.14, 0.1, 8,
               {Material::kWood, 90});
    if (last_top_m) add_wire(city.fixed, *last_top_m, top_m);
    last_top_m = top_m;
  }
}

/// White posts with a reflector that mark the road's edge.
void add_marker_posts(City& city, const BlockSide& side, Random& random) {
  const double spacing_m = random.uniform(24.0, 50.0);
  for (double along_m = random.uniform(5.0, 20.0); along_m < side.length_m - 5.0;
       along_m += spacing_m) {
    const Eigen::Isometry3d frame = frame_at(city, side, along_m, 0.6, 0.0);
    const Part post{city.fixed, frame, {Material::kPlaster, 240}};
    const Part reflector{city.fixed, frame, {Material::kRetroreflector, 60}};
    post.box({-0.06, -0.06, -0.2}, {0.06, 0.06, 1.0});
    reflector.box({-0.03, -0.065, 0.7}, {0.03, 0.065, 0.85});
  }
}

/// Shrubs and tall weeds on the verge.
void plant_verge(City& city, const BlockSide& side, Random& random) {
  for (double along_m = random.uniform(8.0, 30.0); along_m < side.length_m - 8.0;
       along_m += random.uniform(5.0, 35.0)) {
    place_bush(city, side.at(along_m, random.uniform(1.3, 3.2)), -0.2, random);
  }
}

/// Trees in a line along the road, with gaps.
void plant_avenue(City& city, const BlockSide& side, Random& random) {
  const double spacing_m = random.uniform(12.0, 25.0);
  for (double along_m = 15.0; along_m < side.length_m - 15.0; along_m += spacing_m) {
    if (random.chance(0.7)) place_tree(city, side.at(along_m, 3.0), 0.0, random);
  }
}

/// A house and a barn some way back from the road.
void add_farm(City& city, const Block& block, int front, Random& random) {
  const BlockSide side = sides_of(block.sheet_m)[front];
  double from_m = side.length_m * random.uniform(0.2, 0.6);
  for (const double length_m : {11.0, 22.0}) {
    const double back_m = random.uniform(12.0, 26.0);
    const Eigen::AlignedBox2d lot_m =
        box_of(side.at(from_m, back_m), side.at(from_m + length_m, back_m + 0.4 * length_m + 4.0));
    add_house(city, detached_lot(lot_m, front), random);
    place_tree(city, side.at(from_m - 4.0, back_m), 0.0, random);
    from_m += length_m + random.uniform(6.0, 15.0);
  }
}

/// Round bales, lying.
void add_bales(City& city, const Block& block, Random& random) {
  for (int bales = 3 + random.below(10); bales > 0; --bales) {
    const Eigen::Vector2d at = draw_inside(block.sheet_m, 12.0, random);
    const Part bale{city.fixed,
                    upright_frame(city.layout.ground(at, 0.7), random.uniform(0.0, 3.1)),
                    {Material::kGrass, 200}};
    bale.column({-0.6, 0.0, 0.0}, {0.6, 0.0, 0.0}, 0.75, 0.75, 14);
  }
}

}  // namespace

void add_field(City& city, const Block& block, Random& random) {
  for (const BlockSide& side : sides_of(block.sheet_m)) {
    add_edge(city, side, random);
    if (random.chance(0.3)) add_poles(city, side, random);
    if (random.chance(0.6)) add_marker_posts(city, side, random);
    if (random.chance(0.12)) plant_avenue(city, side, random);
    plant_verge(city, side, random);
  }
  const double area_m2 = block.sheet_m.volume();
  const double shortest_m = block.sheet_m.sizes().minCoeff();
  if (shortest_m > 100.0 && random.chance(0.25)) {
    add_farm(city, block, random.below(4), random);
  }
  const int trees = random.below(2 + static_cast<int>(area_m2 / 1500.0));
  scatter(city, place_tree, trees, block.sheet_m, 6.0, 0.0, random);
  const int bushes = random.below(2 + static_cast<int>(area_m2 / 900.0));
  scatter(city, place_bush, bushes, block.sheet_m, 3.0, 0.0, random);
  if (random.chance(0.3)) add_bales(city, block, random);
}

}  // namespace hqslam::sim
