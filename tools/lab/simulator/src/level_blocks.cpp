#include <algorithm>
#include <optional>

#include "block_contents.h"

namespace hqslam::sim {

namespace {

constexpr double kWallSetback_m = 0.7;  ///< from the street
constexpr double kCut_m = 4.0;          ///< by which walls' corners are cut off
constexpr double kPlaceWidth_m = 2.6;   ///< of a parked car
constexpr double kRowEnd_m = 2.5;       ///< free at both ends, where cars turn

/// Two piers that stand out from the wall.
void add_gate(City& city, const BlockSide& side, double along_m, double setback_m, double height_m,
              Random& random) {
  constexpr double kProud_m = 0.3;
  const double width_m = random.uniform(1.4, 3.2);
  const Surface stone{Material::kConcrete, random.shade()};
  for (const double pier_m : {along_m, along_m + width_m}) {
    const Part pier{city.fixed, frame_at(city, side, pier_m, setback_m, 0.0), stone};
    pier.box({-0.2, -kProud_m, -0.2}, {0.2, kProud_m, height_m + 0.2});
  }
}

/// One wall after the other along a side, each of its own height, a hand's breadth before or behind
/// the last.
void add_walls_of_side(City& city, const BlockSide& side, Random& random) {
  const double end_m = side.length_m - kWallSetback_m - kCut_m;
  double from_m = kWallSetback_m + kCut_m;
  while (end_m - from_m > 0.5) {
    double to_m = std::min(end_m, from_m + random.uniform(18.0, 70.0));
    if (end_m - to_m < 10.0) to_m = end_m;
    const double setback_m = kWallSetback_m + random.uniform(-0.1, 0.1);
    const double height_m = random.uniform(2.5, 4.5);
    add_garden_wall(city, side.at(from_m, setback_m), side.at(to_m, setback_m), height_m,
                    {Material::kPlaster, random.shade()});
    add_gate(city, side, random.uniform(from_m + 2.0, to_m - 4.0), setback_m, height_m, random);
    from_m = to_m;
  }
  // The cut corner towards the next side.
  add_garden_wall(city, side.at(end_m, kWallSetback_m),
                  side.at(side.length_m - kWallSetback_m, kWallSetback_m + kCut_m), 3.0,
                  {Material::kPlaster, 150});
}

/// One row along an aisle: cars stand nose or tail to it.
void add_parking_row(City& city, const BlockSide& side, Random& random) {
  for (double along_m = kRowEnd_m + 0.5 * kPlaceWidth_m; along_m < side.length_m - kRowEnd_m - 1.3;
       along_m += kPlaceWidth_m) {
    if (!random.chance(city.parked_car_share)) continue;
    const double inwards_m = 2.55 + random.uniform(-0.15, 0.2);
    const Eigen::Vector2d at = side.at(along_m + random.uniform(-0.12, 0.12), inwards_m);
    const Eigen::Vector2d nose = random.chance(0.3) ? Eigen::Vector2d(-side.inwards) : side.inwards;
    const double askew_rad = random.uniform(-0.04, 0.04);
    park_car(city, at, city.layout.heading_rad(at, nose) + askew_rad, random);
  }
}

/// Hedges and fences keep this distance from crossings, so that drivers can see across them.
constexpr double kCornerRoom_m = 14.0;

/// Stretches along a road, each with a hedge, a fence or nothing.
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

/// A house and a barn set back from the road.
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

/// Round bales on their sides.
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

void add_smooth_walls(City& city, const Block& block, Random& random) {
  for (const BlockSide& side : sides_of(block.sheet_m)) {
    add_walls_of_side(city, side, random);
    for (double along_m = random.uniform(8.0, 40.0); along_m < side.length_m - 8.0;
         along_m += random.uniform(15.0, 60.0)) {
      place_tree(city, side.at(along_m, random.uniform(4.0, 9.0)), 0.0, random);
    }
  }
}

void add_parking_rows(City& city, const Block& block, Random& random) {
  const auto sides = sides_of(block.sheet_m);
  const BlockSide& low = sides[3];
  add_parking_row(city, low, random);
  add_parking_row(city, sides[1], random);
  // Between the rows: a lamp, a tree.
  const double middle_m = 0.5 * block.sheet_m.sizes().x();
  for (double along_m = random.uniform(6.0, 14.0); along_m < low.length_m - 6.0;
       along_m += random.uniform(14.0, 26.0)) {
    const Eigen::Vector2d at = low.at(along_m, middle_m);
    if (random.chance(0.5)) {
      add_lamp(city.fixed, frame_at(city, at, low.along, 0.0));
    } else if (random.chance(0.6)) {
      place_tree(city, at, 0.0, random);
    }
  }
}

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
