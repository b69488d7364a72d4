#include "block_contents.h"

#include <algorithm>
#include <cmath>

namespace hqslam::sim {

namespace {

/// Where gardens, walls and houses begin, from the kerb.
constexpr double kLotLine_m = kSidewalkWidth_m + 0.15;

/// Tubs, shrubs and boxes along the foot of a house.
void plant_tubs(City& city, const BlockSide& side, double from_m, double to_m, Random& random) {
  for (int left = random.below(5); left > 0; --left) {
    const double in_front_m = random.uniform(0.25, 0.6);
    const double along_m = random.uniform(from_m + 0.6, to_m - 0.6);
    const Eigen::Vector2d at = side.at(along_m, kLotLine_m - in_front_m);
    if (random.chance(0.6)) {
      place_bush(city, at, kKerbHeight_m, random);
    } else {
      const double height_m = random.uniform(0.4, 1.3);
      const Part box{city.fixed,
                     frame_at(city, at, side.along, kKerbHeight_m),
                     {Material::kMetal, random.shade()}};
      box.box({-0.3, -0.25, -0.3}, {random.uniform(0.2, 0.8), 0.3, height_m});
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

/// The front of a garden: a fence, a hedge, a wall or nothing, with an open gate in it.
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
      for (int bushes = 2 + random.below(7); bushes > 0; --bushes) {
        const double inwards_m = kLotLine_m + random.uniform(0.9, front_garden_m - 0.5);
        const double along_m = random.uniform(from_m, to_m);
        place_bush(city, side.at(along_m, inwards_m), kKerbHeight_m, random);
      }
      for (int trees = random.below(3); trees > 0; --trees) {
        place_tree(city, side.at(to_m + 0.5 * gap_m, kLotLine_m + random.uniform(1.0, 18.0)),
                   kKerbHeight_m, random);
      }
      from_m = to_m + gap_m;
    }
  }
}

/// A paved square with a monument, benches and a few trees.
void add_square(City& city, const Block& block, Random& random) {
  const Part stone{city.fixed,
                   frame_at(city, block.sheet_m.center(), {1.0, 0.0}, kKerbHeight_m),
                   {Material::kConcrete, 190}};
  stone.box({-2.2, -2.2, -0.5}, {2.2, 2.2, 0.4});
  stone.box({-0.9, -0.9, 0.4}, {0.9, 0.9, 2.2});
  stone.column({0.0, 0.0, 2.2}, {0.0, 0.0, 6.5}, 0.45, 0.3, 10);
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
    add_bench(city.fixed, frame_at(city, side, 0.5 * side.length_m, 5.5, kKerbHeight_m));
  }
}

/// A long blank wall or a high hedge all around: all places along it look alike.
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

/// By BlockKind.
constexpr std::array<void (*)(City&, const Block&, Random&), kBlockKinds> kFill = {
    add_row_houses,  add_detached_houses, add_square,       add_park,        add_walled_ground,
    add_open_ground, add_field,           add_smooth_walls, add_parking_rows};

/// The street along a side of a block; none along the rim of the city.
const Street* street_along(const Layout& layout, const Block& block, int side) {
  const int axis = side % 2 == 0 ? 1 : 0;
  const bool at_low_end = side == 0 || side == 3;
  const double kerb_m = at_low_end ? block.sheet_m.min()[axis] : block.sheet_m.max()[axis];
  for (const Street& street : layout.streets[axis]) {
    const double expected_m = at_low_end ? street.position_m + street.half_width_m
                                         : street.position_m - street.half_width_m;
    if (std::abs(expected_m - kerb_m) < 1e-6) return &street;
  }
  return nullptr;
}

void add_lamps(City& city, const BlockSide& side, Random& random) {
  constexpr double kSpacing_m = 27.0;
  const bool wires = random.chance(0.5);
  const int lamps = static_cast<int>(std::ceil((side.length_m - 16.0) / kSpacing_m));
  Eigen::Vector3d previous_top = Eigen::Vector3d::Zero();
  for (int lamp = 0; lamp < lamps; ++lamp) {
    const double along_m = 8.0 + (side.length_m - 16.0) * (lamp + 0.5) / lamps;
    const Eigen::Isometry3d frame = frame_at(city, side, along_m, 0.5, kKerbHeight_m);
    add_lamp(city.fixed, frame);
    const Eigen::Vector3d top = frame * Eigen::Vector3d(0.0, 0.0, 6.6);
    if (wires && lamp > 0) add_wire(city.fixed, previous_top, top);
    previous_top = top;
  }
}

void plant_street_trees(City& city, const BlockSide& side, Random& random) {
  double along_m = 9.0 + random.uniform(0.0, 4.0);
  while (along_m < side.length_m - 9.0) {
    if (random.chance(0.85)) place_tree(city, side.at(along_m, 1.0), kKerbHeight_m, random);
    along_m += random.uniform(6.5, 11.0);
  }
}

/// Cars stand with the kerb on their right.
void park_cars(City& city, const BlockSide& side, double share, Random& random) {
  double along_m = 13.0;
  while (along_m < side.length_m - 13.0) {
    if (random.chance(share)) {
      const Eigen::Vector2d at = side.at(along_m, -1.15 + random.uniform(-0.1, 0.12));
      const double heading_rad =
          city.layout.heading_rad(at, -side.along) + random.uniform(-0.03, 0.03);
      park_car(city, at, heading_rad, random);
    }
    along_m += random.uniform(5.7, 7.0);
  }
}

void add_small_things(City& city, const BlockSide& side, bool wide_street, Random& random) {
  add_traffic_sign(city.fixed, frame_at(city, side, 6.5, 0.45, kKerbHeight_m), random);
  if (random.chance(0.5)) {
    add_traffic_sign(
        city.fixed,
        frame_at(city, side, side.length_m * random.uniform(0.3, 0.8), 0.45, kKerbHeight_m),
        random);
  }
  if (wide_street) add_traffic_light(city.fixed, frame_at(city, side, 4.2, 0.6, kKerbHeight_m));
  for (int bins = random.below(4); bins > 0; --bins) {
    const double inwards_m = random.chance(0.5) ? 0.5 : 2.6;
    const double along_m = random.uniform(6.0, side.length_m - 6.0);
    add_bin(city.fixed, frame_at(city, side, along_m, inwards_m, kKerbHeight_m), random);
  }
  if (random.chance(0.3)) {
    add_bench(city.fixed,
              frame_at(city, side, side.length_m * random.uniform(0.3, 0.7), 2.3, kKerbHeight_m));
  }
}

}  // namespace

void fill_block(City& city, const Block& block) {
  Random random(seed_of(block.seed, 21));
  kFill[static_cast<std::size_t>(block.kind)](city, block, random);
}

void furnish_sidewalks(City& city, const Block& block) {
  Random random(seed_of(block.seed, 22));
  const auto sides = sides_of(block.sheet_m);
  const bool poor = block.kind == BlockKind::kOpenLand || block.kind == BlockKind::kWalled;
  for (int k = 0; k < 4; ++k) {
    const Street* street = street_along(city.layout, block, k);
    if (street == nullptr) continue;
    const BlockSide& side = sides[k];
    if (!poor) {
      add_lamps(city, side, random);
      add_small_things(city, side, street->half_width_m > 7.0, random);
      if (street->tree_lined) plant_street_trees(city, side, random);
    }
    if (street->parking) {
      park_cars(city, side, (poor ? 0.1 : 1.0) * city.parked_car_share, random);
    }
  }
}

}  // namespace hqslam::sim
