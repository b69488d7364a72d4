#include "furniture.h"
#include "level_blocks.h"

namespace hqslam::sim {

namespace {

constexpr double kPlaceWidth_m = 2.6;
constexpr double kRowEnd_m = 2.5;  ///< free at both ends, for those who turn

/// One row along an aisle: cars stand nose or tail to it.
void add_row(City& city, const BlockSide& side, double parked_car_share, Random& random) {
  for (double along_m = kRowEnd_m + 0.5 * kPlaceWidth_m; along_m < side.length_m - kRowEnd_m - 1.3;
       along_m += kPlaceWidth_m) {
    if (!random.chance(parked_car_share)) continue;
    const double inwards_m = 2.55 + random.uniform(-0.15, 0.2);
    const Eigen::Vector2d at = side.at(along_m + random.uniform(-0.12, 0.12), inwards_m);
    const Eigen::Vector2d nose = random.chance(0.3) ? Eigen::Vector2d(-side.inwards) : side.inwards;
    const double askew_rad = random.uniform(-0.04, 0.04);
    park_car(city, at, city.layout.heading_rad(at, nose) + askew_rad, random);
  }
}

}  // namespace

void add_parking_rows(City& city, const Block& block, double parked_car_share, Random& random) {
  const BlockSide low = side_of(block.sheet_m, 3);
  const BlockSide high = side_of(block.sheet_m, 1);
  add_row(city, low, parked_car_share, random);
  add_row(city, high, parked_car_share, random);
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

}  // namespace hqslam::sim
