#include <array>
#include <cmath>

#include "indoor_plan.h"
#include "random.h"

namespace hqslam::sim {

namespace {

void add_legs(const Part& part, const std::array<double, 2>& x_m, const std::array<double, 2>& y_m,
              double thickness_m, double height_m) {
  for (const double x : x_m) {
    for (const double y : y_m) part.box({x, y, 0.0}, {x + thickness_m, y + thickness_m, height_m});
  }
}

void add_table(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random) {
  const double half_m = random.uniform(0.5, 0.9);
  const Part wood{mesh, frame, {Material::kWood, random.shade()}};
  wood.box({-half_m, -0.4, 0.71}, {half_m, 0.4, 0.74});
  add_legs(wood, {-half_m + 0.03, half_m - 0.08}, {-0.37, 0.32}, 0.05, 0.71);
  if (random.chance(0.6)) {  // a screen
    add_box(mesh, frame, {-0.28, 0.1, 0.8}, {0.28, 0.14, 1.15}, {Material::kMetal, 30});
  }
}

void add_chair(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random) {
  const Part cloth{mesh, frame, {Material::kCloth, random.shade()}};
  cloth.box({-0.22, -0.22, 0.42}, {0.22, 0.22, 0.48});
  cloth.box({-0.22, 0.18, 0.48}, {0.22, 0.22, 0.95});
  add_legs({mesh, frame, {Material::kMetal, 100}}, {-0.2, 0.17}, {-0.2, 0.17}, 0.03, 0.42);
}

/// Boards with gaps between them, some filled.
void add_shelf(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random) {
  const double half_m = random.uniform(0.4, 0.8);
  const Part wood{mesh, frame, {Material::kWood, random.shade()}};
  for (const double x_m : {-half_m, half_m - 0.03}) {
    wood.box({x_m, -0.17, 0.0}, {x_m + 0.03, 0.17, 1.9});
  }
  for (int board = 0; board < 6; ++board) {
    const double z_m = 0.05 + 0.36 * board;
    wood.box({-half_m, -0.17, z_m}, {half_m, 0.17, z_m + 0.03});
    const double filled_m = random.uniform(-half_m, half_m);
    if (board == 5) continue;
    const Part books{mesh, frame, {Material::kCloth, random.shade()}};
    books.box({-half_m, -0.1, z_m}, {filled_m, 0.17, z_m + 0.26});
  }
}

void add_cupboard(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random) {
  const double half_m = random.uniform(0.3, 0.6);
  const double height_m = random.uniform(0.8, 2.0);
  const Part wood{mesh, frame, {Material::kWood, random.shade()}};
  wood.box({-half_m, -0.25, 0.0}, {half_m, 0.25, height_m});
}

}  // namespace

void furnish_room(TriangleMesh& mesh, const Room& room) {
  Random random(seed_of(room.seed, 3));
  constexpr double kMargin_m = 0.95;  ///< no thing reaches further from its middle
  const Eigen::Vector2d free_m = middle_of(room);
  const double near_m = kCorridorHalfWidth_m + kWall_m + 0.5;
  const double far_m = kHalfDepth_m - 0.5;
  const int things = static_cast<int>(2.2 * (room.to_x_m - room.from_x_m));
  for (int thing = 0; thing < things; ++thing) {
    const double x_m =
        random.uniform(room.from_x_m + kMargin_m + 0.1, room.to_x_m - kMargin_m - 0.1);
    const double y_m = room.side * random.uniform(near_m, far_m);
    const double kind = random.uniform();
    const double heading_rad = random.chance(0.5) ? 0.0 : 3.14159265358979;
    const bool in_the_way =
        (Eigen::Vector2d(x_m, y_m) - free_m).norm() < kFreeRadius_m + kMargin_m ||
        (std::abs(x_m - free_m.x()) < 0.7 + kMargin_m && std::abs(y_m) < std::abs(free_m.y()));
    if (in_the_way) continue;
    const Eigen::Isometry3d frame = upright_frame({x_m, y_m, room.floor_m()}, heading_rad);
    const auto add = kind < 0.3   ? add_table
                     : kind < 0.6 ? add_chair
                     : kind < 0.8 ? add_shelf
                                  : add_cupboard;
    add(mesh, frame, random);
  }
}

}  // namespace hqslam::sim
