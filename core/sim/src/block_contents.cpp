#include <algorithm>

#include "building.h"
#include "city.h"
#include "furniture.h"
#include "level_blocks.h"

namespace hqslam::sim {

namespace {

/// Where gardens, walls and houses begin, from the kerb.
constexpr double kLotLine_m = kSidewalkWidth_m + 0.15;

/// Tubs, shrubs and boxes along the foot of a house.
void plant_tubs(City& city, const BlockSide& side, double from_m, double to_m, Random& random) {
  const int count = random.below(5);
  for (int k = 0; k < count; ++k) {
    const double in_front_m = random.uniform(0.25, 0.6);
    const double along_m = random.uniform(from_m + 0.6, to_m - 0.6);
    const Eigen::Vector2d at = side.at(along_m, kLotLine_m - in_front_m);
    if (random.chance(0.6)) {
      place_bush(city, at, kKerbHeight_m, random);
    } else {
      const double height_m = random.uniform(0.4, 1.3);
      const Surface metal{Material::kMetal, random.shade()};
      const double end_m = random.uniform(0.2, 0.8);
      add_box(city.fixed, frame_at(city, at, side.along, kKerbHeight_m), {-0.3, -0.25, -0.3},
              {end_m, 0.3, height_m}, metal);
    }
  }
}

/// Closed house fronts around a yard, with a gap here and there.
void add_row_houses(City& city, const Block& block, Random& random) {
  const double room_m = block.sheet_m.sizes().minCoeff() - 2.0 * kLotLine_m;
  const double depth_m = std::min(random.uniform(9.0, 12.0), 0.4 * room_m);
  const auto sides = sides_of(block.sheet_m);
  for (int k = 0; k < 4; ++k) {
    const BlockSide& side = sides[k];
    // Sides 0 and 2 take the corners.
    const double corner_m = kLotLine_m + (k % 2 == 0 ? 0.0 : depth_m);
    const double end_m = side.length_m - corner_m;
    double from_m = corner_m;
    while (end_m - from_m > 5.0) {
      double to_m = std::min(end_m, from_m + random.uniform(7.0, 13.5));
      if (end_m - to_m < 5.0) to_m = end_m;
      const bool first = from_m == corner_m;
      const bool last = to_m == end_m;
      if (first || last || !random.chance(0.2)) {
        const double setback_m = kLotLine_m + (first || last ? 0.0 : random.uniform(0.0, 1.6));
        HouseLot lot{box_of(side.at(from_m, setback_m), side.at(to_m, kLotLine_m + depth_m)), k};
        lot.open_to_view[k] = true;
        if (k % 2 == 0 && first) lot.open_to_view[(k + 3) % 4] = true;
        if (k % 2 == 0 && last) lot.open_to_view[(k + 1) % 4] = true;
        add_house(city, lot, random);
        plant_tubs(city, side, from_m, to_m, random);
      } else {
        add_garden_wall(city, side.at(from_m, kLotLine_m), side.at(to_m, kLotLine_m), 1.8,
                        {Material::kPlaster, random.shade()});
        for (const double behind_m : {3.5, 9.0, 15.0}) {
          place_tree(city, side.at(random.uniform(from_m, to_m), kLotLine_m + behind_m),
                     kKerbHeight_m, random);
        }
      }
      from_m = to_m;
    }
  }
}

/// What a garden shows to the street, with a gate left open.
void add_garden_front(City& city, const BlockSide& side, double from_m, double to_m,
                      Random& random) {
  const double gate_m = from_m + (to_m - from_m) * random.uniform(0.2, 0.6);
  const double kind = random.uniform();
  const Surface masonry{Material::kConcrete, random.shade()};
  for (const auto& [a_m, b_m] : {std::pair{from_m, gate_m}, std::pair{gate_m + 1.6, to_m}}) {
    if (b_m - a_m < 0.8) continue;
    const Eigen::Vector2d a = side.at(a_m, kLotLine_m + 0.4);
    const Eigen::Vector2d b = side.at(b_m, kLotLine_m + 0.4);
    if (kind < 0.35) {
      add_picket_fence(city, a, b, random);
    } else if (kind < 0.7) {
      add_hedge(city, a, b, random.uniform(1.0, 1.9), random);
    } else if (kind < 0.9) {
      add_garden_wall(city, a, b, random.uniform(0.8, 1.4), masonry);
    }
  }
}

void add_detached_houses(City& city, const Block& block, Random& random) {
  const double room_m = block.sheet_m.sizes().minCoeff() - 2.0 * kLotLine_m;
  const double front_garden_m = random.uniform(4.0, 6.5);
  const double depth_m = std::min(9.5, 0.5 * room_m - front_garden_m - 0.5);
  const auto sides = sides_of(block.sheet_m);
  for (int k = 0; k < 4; ++k) {
    const BlockSide& side = sides[k];
    const double corner_m =
        kLotLine_m + (k % 2 == 0 ? front_garden_m : front_garden_m + depth_m + 2.5);
    double from_m = corner_m;
    add_garden_front(city, side, kLotLine_m, corner_m, random);
    add_garden_front(city, side, side.length_m - corner_m, side.length_m - kLotLine_m, random);
    while (side.length_m - corner_m - from_m > 7.5) {
      const double to_m = std::min(side.length_m - corner_m, from_m + random.uniform(8.0, 13.0));
      const Eigen::AlignedBox2d lot_m =
          box_of(side.at(from_m, kLotLine_m + front_garden_m),
                 side.at(to_m, kLotLine_m + front_garden_m + depth_m));
      add_house(city, detached_lot(lot_m, k), random);
      const double gap_m = random.uniform(2.5, 6.0);
      add_garden_front(city, side, from_m, to_m + gap_m, random);
      const int bushes = 2 + random.below(7);
      for (int bush = 0; bush < bushes; ++bush) {
        const double inwards_m = kLotLine_m + random.uniform(0.9, front_garden_m - 0.5);
        const double along_m = random.uniform(from_m, to_m);
        place_bush(city, side.at(along_m, inwards_m), kKerbHeight_m, random);
      }
      const int trees = random.below(3);
      for (int tree = 0; tree < trees; ++tree) {
        place_tree(city, side.at(to_m + 0.5 * gap_m, kLotLine_m + random.uniform(1.0, 18.0)),
                   kKerbHeight_m, random);
      }
      from_m = to_m + gap_m;
    }
  }
}

/// A paved square: a monument, benches, a few trees, much room.
void add_square(City& city, const Block& block, Random& random) {
  const Eigen::Isometry3d middle =
      frame_at(city, block.sheet_m.center(), {1.0, 0.0}, kKerbHeight_m);
  const Surface stone{Material::kConcrete, 190};
  add_box(city.fixed, middle, {-2.2, -2.2, -0.5}, {2.2, 2.2, 0.4}, stone);
  add_box(city.fixed, middle, {-0.9, -0.9, 0.4}, {0.9, 0.9, 2.2}, stone);
  add_column(city.fixed, middle, {0.0, 0.0, 2.2}, {0.0, 0.0, 6.5}, 0.45, 0.3, 10, stone);
  scatter(city, place_tree, 4 + random.below(8), block.sheet_m, 7.0, kKerbHeight_m, random);
  for (int bench = 0; bench < 8; ++bench) {
    const Eigen::Vector2d at = draw_inside(block.sheet_m, 6.0, random);
    const Eigen::Vector2d along = Eigen::Vector2d::Unit(random.chance(0.5) ? 0 : 1);
    add_bench(city.fixed, frame_at(city, at, along, kKerbHeight_m));
  }
}

void add_park(City& city, const Block& block, Random& random) {
  const double area_m2 = block.sheet_m.volume();
  const int trees = static_cast<int>(area_m2 / 95.0);
  const int bushes = static_cast<int>(area_m2 / 120.0);
  scatter(city, place_tree, trees, block.sheet_m, 5.0, kKerbHeight_m, random);
  scatter(city, place_bush, bushes, block.sheet_m, 4.5, kKerbHeight_m, random);
  for (const BlockSide& side : sides_of(block.sheet_m)) {
    if (random.chance(0.5)) {
      add_hedge(city, side.at(8.0, kLotLine_m + 0.5),
                side.at(side.length_m - 8.0, kLotLine_m + 0.5), random.uniform(0.8, 1.2), random);
    }
    add_bench(city.fixed,
              frame_at(city, side.at(0.5 * side.length_m, 5.5), side.along, kKerbHeight_m));
  }
}

/// A long blank wall or a high hedge all around: nothing that tells one place from another.
void add_walled_ground(City& city, const Block& block, Random& random) {
  const bool hedge = random.chance(0.4);
  const Surface masonry{Material::kPlaster, random.shade()};
  const double height_m = random.uniform(2.2, 3.2);
  for (const BlockSide& side : sides_of(block.sheet_m)) {
    const Eigen::Vector2d a = side.at(kLotLine_m, kLotLine_m + 0.3);
    const Eigen::Vector2d b = side.at(side.length_m - kLotLine_m, kLotLine_m + 0.3);
    if (hedge) {
      add_hedge(city, a, b, height_m, random);
    } else {
      add_garden_wall(city, a, b, height_m, masonry);
    }
  }
}

void add_open_ground(City& city, const Block& block, Random& random) {
  const int trees = static_cast<int>(block.sheet_m.volume() / 1500.0);
  scatter(city, place_tree, trees, block.sheet_m, 10.0, kKerbHeight_m, random);
}

}  // namespace

void fill_block(City& city, const Block& block, double parked_car_share) {
  Random random(seed_of(block.seed, 21));
  switch (block.kind) {
    case BlockKind::kRowHouses:
      return add_row_houses(city, block, random);
    case BlockKind::kDetachedHouses:
      return add_detached_houses(city, block, random);
    case BlockKind::kSquare:
      return add_square(city, block, random);
    case BlockKind::kPark:
      return add_park(city, block, random);
    case BlockKind::kWalled:
      return add_walled_ground(city, block, random);
    case BlockKind::kOpenLand:
      return add_open_ground(city, block, random);
    case BlockKind::kField:
      return add_field(city, block, random);
    case BlockKind::kSmoothWalls:
      return add_smooth_walls(city, block, random);
    case BlockKind::kYard:
      return add_yard(city, block, random);
    case BlockKind::kParkingRows:
      return add_parking_rows(city, block, parked_car_share, random);
  }
}

}  // namespace hqslam::sim
