#include <algorithm>

#include "furniture.h"
#include "level_blocks.h"

namespace hqslam::sim {

namespace {

constexpr double kSetback_m = 0.7;  ///< from the street
constexpr double kCut_m = 4.0;      ///< by which corners are cut off

/// Two piers that stand out from the wall.
void add_gate(City& city, const BlockSide& side, double along_m, double setback_m, double height_m,
              Random& random) {
  constexpr double kProud_m = 0.3;
  const double width_m = random.uniform(1.4, 3.2);
  const Surface stone{Material::kConcrete, random.shade()};
  for (const double pier_m : {along_m, along_m + width_m}) {
    const Eigen::Isometry3d frame = frame_at(city, side.at(pier_m, setback_m), side.along, 0.0);
    add_box(city.fixed, frame, {-0.2, -kProud_m, -0.2}, {0.2, kProud_m, height_m + 0.2}, stone);
  }
}

/// One wall after the other along a side, each of its own height, a hand's breadth before or behind
/// the last.
void add_walls_of_side(City& city, const BlockSide& side, Random& random) {
  const double end_m = side.length_m - kSetback_m - kCut_m;
  double from_m = kSetback_m + kCut_m;
  while (end_m - from_m > 0.5) {
    double to_m = std::min(end_m, from_m + random.uniform(18.0, 70.0));
    if (end_m - to_m < 10.0) to_m = end_m;
    const double setback_m = kSetback_m + random.uniform(-0.1, 0.1);
    const double height_m = random.uniform(2.5, 4.5);
    const Surface plaster{Material::kPlaster, random.shade()};
    add_garden_wall(city.fixed, city.layout, side.at(from_m, setback_m), side.at(to_m, setback_m),
                    height_m, plaster);
    add_gate(city, side, random.uniform(from_m + 2.0, to_m - 4.0), setback_m, height_m, random);
    from_m = to_m;
  }
  // The cut corner towards the next side.
  add_garden_wall(city.fixed, city.layout, side.at(end_m, kSetback_m),
                  side.at(side.length_m - kSetback_m, kSetback_m + kCut_m), 3.0,
                  {Material::kPlaster, 150});
}

}  // namespace

void add_smooth_walls(City& city, const Block& block, Random& random) {
  for (int k = 0; k < 4; ++k) {
    const BlockSide side = side_of(block.sheet_m, k);
    add_walls_of_side(city, side, random);
    for (double along_m = random.uniform(8.0, 40.0); along_m < side.length_m - 8.0;
         along_m += random.uniform(15.0, 60.0)) {
      place_tree(city, side.at(along_m, random.uniform(4.0, 9.0)), 0.0, random);
    }
  }
}

}  // namespace hqslam::sim
