#include <cmath>

#include "city.h"
#include "furniture.h"

namespace hqslam::sim {

namespace {

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
