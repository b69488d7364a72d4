#include <algorithm>
#include <array>
#include <cmath>

#include "indoor_plan.h"
#include "random.h"

namespace hqslam::sim {

namespace {

constexpr Surface kPlaster{Material::kPlaster, 190};
constexpr Surface kFloor{Material::kWood, 130};
constexpr Surface kStone{Material::kConcrete, 140};
constexpr Surface kRail{Material::kMetal, 120};

/// A box between any two opposite corners.
void add(TriangleMesh& mesh, const Eigen::Vector3d& a, const Eigen::Vector3d& b, Surface surface) {
  add_box(mesh, Eigen::Isometry3d::Identity(), a.cwiseMin(b), a.cwiseMax(b), surface);
}

/// A hole in a wall along x.
struct Opening {
  double from_x_m;
  double to_x_m;
  double low_m;  ///< above the floor
  double high_m;
  bool glazed = false;
};

/// A wall along x from floor to ceiling; openings in the order of x.
void add_wall(TriangleMesh& mesh, double from_x_m, double to_x_m, double low_y_m, double floor_m,
              const std::vector<Opening>& openings) {
  const double high_y_m = low_y_m + kWall_m;
  const double top_m = floor_m + kStorey_m;
  const auto piece = [&](double x0_m, double x1_m, double z0_m, double z1_m) {
    if (x1_m - x0_m > 1e-3 && z1_m - z0_m > 1e-3) {
      add(mesh, {x0_m, low_y_m, z0_m}, {x1_m, high_y_m, z1_m}, kPlaster);
    }
  };
  double x_m = from_x_m;
  for (const Opening& opening : openings) {
    piece(x_m, opening.from_x_m, floor_m, top_m);
    piece(opening.from_x_m, opening.to_x_m, floor_m, floor_m + opening.low_m);
    piece(opening.from_x_m, opening.to_x_m, floor_m + opening.high_m, top_m);
    if (opening.glazed) {
      const double y_m = low_y_m + 0.5 * kWall_m;
      add_quad(mesh, {opening.from_x_m, y_m, floor_m + opening.low_m},
               {opening.to_x_m, y_m, floor_m + opening.low_m},
               {opening.to_x_m, y_m, floor_m + opening.high_m},
               {opening.from_x_m, y_m, floor_m + opening.high_m}, {Material::kGlass, 200});
    }
    x_m = opening.to_x_m;
  }
  piece(x_m, to_x_m, floor_m, top_m);
}

/// A wall along y from floor to ceiling.
void add_cross_wall(TriangleMesh& mesh, double low_x_m, double from_y_m, double to_y_m,
                    double floor_m) {
  add(mesh, {low_x_m, from_y_m, floor_m}, {low_x_m + kWall_m, to_y_m, floor_m + kStorey_m},
      kPlaster);
}

/// The door's leaf stands open, into the room.
void add_door_leaf(TriangleMesh& mesh, const Room& room, Random& random) {
  const double x_m = room.door_x_m + 0.5 * kDoorWidth_m;
  const double y0_m = room.side * (kCorridorHalfWidth_m + kWall_m);
  const double y1_m = y0_m + room.side * 0.95;
  add(mesh, {x_m, y0_m, room.floor_m()}, {x_m + 0.04, y1_m, room.floor_m() + kDoorHeight_m},
      {Material::kWood, random.shade()});
}

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

/// Furniture of a room, clear of its middle and of the path to the door.
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

/// Corridor wall, outer wall and partitions of one side of a storey.
void add_rooms(TriangleMesh& mesh, const IndoorPlan& plan, int storey, int side) {
  const double floor_m = storey * kStorey_m;
  const double end_m = plan.length_m - kStairwell_m;
  std::vector<Opening> doors;
  std::vector<Opening> windows;
  for (const Room& room : plan.rooms) {
    if (room.storey != storey || room.side != side) continue;
    Random random(seed_of(room.seed, 1));
    doors.push_back({room.door_x_m - 0.5 * kDoorWidth_m, room.door_x_m + 0.5 * kDoorWidth_m, 0.0,
                     kDoorHeight_m});
    const int count = std::max(1, static_cast<int>((room.to_x_m - room.from_x_m) / 2.6));
    const double bay_m = (room.to_x_m - room.from_x_m) / count;
    for (int window = 0; window < count; ++window) {
      const double middle_m = room.from_x_m + (window + 0.5) * bay_m;
      windows.push_back({middle_m - 0.7, middle_m + 0.7, 0.9, 2.3, true});
    }
    const double near_y_m = side * (kCorridorHalfWidth_m + kWall_m);
    add_cross_wall(mesh, room.to_x_m - 0.5 * kWall_m, near_y_m, side * kHalfDepth_m, floor_m);
    if (random.chance(0.6)) add_door_leaf(mesh, room, random);
    furnish_room(mesh, room);
  }
  add_cross_wall(mesh, kStairwell_m - 0.5 * kWall_m, side * kCorridorHalfWidth_m,
                 side * kHalfDepth_m, floor_m);
  add_cross_wall(mesh, end_m - 0.5 * kWall_m, side * kCorridorHalfWidth_m,
                 side * kStairwellHalfWidth_m, floor_m);
  const auto low_y_m = [&](double near_m) { return side > 0 ? near_m : -near_m - kWall_m; };
  add_wall(mesh, kStairwell_m, end_m, low_y_m(kCorridorHalfWidth_m), floor_m, doors);
  add_wall(mesh, kStairwell_m, end_m, low_y_m(kHalfDepth_m), floor_m, windows);
}

/// The stairwell at small x, or its mirror image at the other end.
struct Stairwell {
  TriangleMesh& mesh;
  double length_m;  ///< of the building
  bool at_low_end;

  double x(double from_outer_wall_m) const {
    return at_low_end ? from_outer_wall_m : length_m - from_outer_wall_m;
  }
  void box(const Eigen::Vector3d& a, const Eigen::Vector3d& b, Surface surface) {
    add(mesh, {x(a.x()), a.y(), a.z()}, {x(b.x()), b.y(), b.z()}, surface);
  }

  void add_walls() {
    constexpr double kTop_m = kStoreys * kStorey_m;
    constexpr double kSide_m = kStairwellHalfWidth_m;
    box({-kWall_m, -kSide_m - kWall_m, 0.0}, {0.0, kSide_m + kWall_m, kTop_m}, kPlaster);
    box({0.0, -kSide_m - kWall_m, 0.0}, {kStairwell_m, -kSide_m, kTop_m}, kPlaster);
    box({0.0, kSide_m, 0.0}, {kStairwell_m, kSide_m + kWall_m, kTop_m}, kPlaster);
    // The floor at the head of the stairs.
    box({kFlightEnd_m, -kSide_m, kStorey_m - kSlab_m}, {kStairwell_m, kSide_m, kStorey_m}, kStone);
  }

  void add_flights() {
    constexpr double kSide_m = kStairwellHalfWidth_m;
    constexpr double kHalfway_m = 0.5 * kStorey_m;
    for (int step = 0; step < kStepsOfFlight; ++step) {
      const double top_m = kRise_m * (step + 1);
      const double first_x_m = kFlightEnd_m - kTread_m * (step + 1);
      box({first_x_m, -kSide_m, 0.0}, {first_x_m + kTread_m, -0.05, top_m}, kStone);
      const double second_x_m = kLanding_m + kTread_m * step;
      box({second_x_m, 0.05, kHalfway_m + top_m - 0.35},
          {second_x_m + kTread_m, kSide_m, kHalfway_m + top_m}, kStone);
    }
    box({0.0, -kSide_m, kHalfway_m - kSlab_m}, {kLanding_m, kSide_m, kHalfway_m}, kStone);
  }

  /// Bars between the flights, and before the drop at the head of the first one.
  void add_rails() {
    constexpr double kHeight_m = 0.95;
    const auto bar = [&](const Eigen::Vector3d& foot) {
      add_column(mesh, foot, foot + Eigen::Vector3d(0.0, 0.0, kHeight_m), 0.012, 0.012, 5, kRail);
    };
    const auto hand_rail = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
      const Eigen::Vector3d up(0.0, 0.0, kHeight_m);
      add_column(mesh, from + up, to + up, 0.025, 0.025, 6, kRail);
    };
    const Eigen::Vector3d foot(x(kFlightEnd_m), 0.0, 0.0);
    const Eigen::Vector3d halfway(x(kLanding_m), 0.0, 0.5 * kStorey_m);
    const Eigen::Vector3d head(x(kFlightEnd_m), 0.0, kStorey_m);
    for (int step = 0; step <= kStepsOfFlight; ++step) {
      const double share = static_cast<double>(step) / kStepsOfFlight;
      bar(foot + share * (halfway - foot));
      bar(halfway + share * (head - halfway));
    }
    hand_rail(foot, halfway);
    hand_rail(halfway, head);
    for (int k = 1; k < 9; ++k) bar(head - Eigen::Vector3d(0.0, 0.15 * k, 0.0));
    hand_rail(head, head - Eigen::Vector3d(0.0, kStairwellHalfWidth_m, 0.0));
  }
};

void add_slabs(TriangleMesh& mesh, const IndoorPlan& plan) {
  const double end_m = plan.length_m - kStairwell_m;
  add_quad(mesh, {0.0, -kHalfDepth_m, 0.0}, {plan.length_m, -kHalfDepth_m, 0.0},
           {plan.length_m, kHalfDepth_m, 0.0}, {0.0, kHalfDepth_m, 0.0}, kFloor);
  for (int storey = 1; storey < kStoreys; ++storey) {
    const double z_m = storey * kStorey_m;
    add(mesh, {kStairwell_m, -kHalfDepth_m, z_m - kSlab_m}, {end_m, kHalfDepth_m, z_m}, kFloor);
  }
  constexpr double kRoof_m = kStoreys * kStorey_m;
  add(mesh, {-kWall_m, -kHalfDepth_m, kRoof_m - kSlab_m},
      {plan.length_m + kWall_m, kHalfDepth_m, kRoof_m}, kPlaster);
}

/// Cupboards and bins along a corridor, where there is no door.
void furnish_corridor(TriangleMesh& mesh, const IndoorPlan& plan, int storey, std::uint64_t seed) {
  Random random(seed);
  const double floor_m = storey * kStorey_m;
  for (double x_m = kStairwell_m + 1.0; x_m < plan.length_m - kStairwell_m - 2.0;
       x_m += random.uniform(2.0, 6.0)) {
    const double side = random.chance(0.5) ? 1.0 : -1.0;
    const double length_m = random.uniform(0.3, 1.2);
    const double height_m = random.chance(0.4) ? 1.9 : 0.8;
    const Surface surface{Material::kMetal, random.shade()};
    const bool before_door = std::ranges::any_of(plan.rooms, [&](const Room& room) {
      return room.storey == storey && room.side * side > 0.0 && room.door_x_m + 0.7 > x_m &&
             room.door_x_m - 0.7 < x_m + length_m;
    });
    if (before_door) continue;
    const double wall_m = side * kCorridorHalfWidth_m;
    add(mesh, {x_m, wall_m, floor_m}, {x_m + length_m, wall_m - side * 0.35, floor_m + height_m},
        surface);
  }
}

}  // namespace

TriangleMesh make_indoor_mesh(const IndoorPlan& plan) {
  TriangleMesh mesh;
  add_slabs(mesh, plan);
  for (int storey = 0; storey < kStoreys; ++storey) {
    for (const int side : {-1, 1}) add_rooms(mesh, plan, storey, side);
    furnish_corridor(mesh, plan, storey, seed_of(plan.rooms.front().seed, 2, storey));
  }
  for (const bool at_low_end : {true, false}) {
    Stairwell stairwell{mesh, plan.length_m, at_low_end};
    stairwell.add_walls();
    stairwell.add_flights();
    stairwell.add_rails();
  }
  return mesh;
}

}  // namespace hqslam::sim
