#include <cmath>

#include "indoor_mesh.h"
#include "random.h"

namespace hqslam::sim {

namespace {

void add_table(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random) {
  const double half_m = random.uniform(0.5, 0.9);
  const Surface wood{Material::kWood, random.shade()};
  add_box(mesh, frame, {-half_m, -0.4, 0.71}, {half_m, 0.4, 0.74}, wood);
  for (const double x_m : {-half_m + 0.03, half_m - 0.08}) {
    for (const double y_m : {-0.37, 0.32}) {
      add_box(mesh, frame, {x_m, y_m, 0.0}, {x_m + 0.05, y_m + 0.05, 0.71}, wood);
    }
  }
  if (random.chance(0.6)) {  // a screen
    add_box(mesh, frame, {-0.28, 0.1, 0.8}, {0.28, 0.14, 1.15}, {Material::kMetal, 30});
  }
}

void add_chair(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random) {
  const Surface cloth{Material::kCloth, random.shade()};
  add_box(mesh, frame, {-0.22, -0.22, 0.42}, {0.22, 0.22, 0.48}, cloth);
  add_box(mesh, frame, {-0.22, 0.18, 0.48}, {0.22, 0.22, 0.95}, cloth);
  for (const double x_m : {-0.2, 0.17}) {
    for (const double y_m : {-0.2, 0.17}) {
      add_box(mesh, frame, {x_m, y_m, 0.0}, {x_m + 0.03, y_m + 0.03, 0.42},
              {Material::kMetal, 100});
    }
  }
}

/// Boards with gaps between them, some filled.
void add_shelf(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random) {
  const double half_m = random.uniform(0.4, 0.8);
  const Surface wood{Material::kWood, random.shade()};
  for (const double x_m : {-half_m, half_m - 0.03}) {
    add_box(mesh, frame, {x_m, -0.17, 0.0}, {x_m + 0.03, 0.17, 1.9}, wood);
  }
  for (int board = 0; board < 6; ++board) {
    const double z_m = 0.05 + 0.36 * board;
    add_box(mesh, frame, {-half_m, -0.17, z_m}, {half_m, 0.17, z_m + 0.03}, wood);
    const double filled_m = random.uniform(-half_m, half_m);
    if (board < 5) {
      add_box(mesh, frame, {-half_m, -0.1, z_m}, {filled_m, 0.17, z_m + 0.26},
              {Material::kCloth, random.shade()});
    }
  }
}

void add_cupboard(TriangleMesh& mesh, const Eigen::Isometry3d& frame, Random& random) {
  const double half_m = random.uniform(0.3, 0.6);
  const double height_m = random.uniform(0.8, 2.0);
  add_box(mesh, frame, {-half_m, -0.25, 0.0}, {half_m, 0.25, height_m},
          {Material::kWood, random.shade()});
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
    const Eigen::Isometry3d frame = upright_frame({x_m, y_m, room.storey * kStorey_m}, heading_rad);
    if (kind < 0.3) {
      add_table(mesh, frame, random);
    } else if (kind < 0.6) {
      add_chair(mesh, frame, random);
    } else if (kind < 0.8) {
      add_shelf(mesh, frame, random);
    } else {
      add_cupboard(mesh, frame, random);
    }
  }
}

}  // namespace hqslam::sim
