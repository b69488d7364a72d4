#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mesh.h"

namespace hqslam::sim {

constexpr int kStoreys = 2;
constexpr double kStorey_m = 3.2;
constexpr double kSlab_m = 0.2;  ///< the ceiling is below it
constexpr double kWall_m = 0.15;
constexpr double kCorridorHalfWidth_m = 1.15;
constexpr double kRoomDepth_m = 6.0;
constexpr double kHalfDepth_m = kCorridorHalfWidth_m + kWall_m + kRoomDepth_m;
constexpr double kDoorWidth_m = 1.0;
constexpr double kDoorHeight_m = 2.1;

/// A building of two storeys, each a corridor along x with rooms on both sides; a stairwell at
/// each end of the corridors, with two flights and a landing.
///
///   y  +---------+----+--------+------------------+
///   ^  | stairs  | room | room |  ...     | stairs |   rooms: side +1
///   |  |  well   |------ corridor --------|  well  |   y = 0
///   |  |         | room |  room    | ...  |        |   rooms: side -1
///      0    kStairwell_m           length_m - kStairwell_m
struct Room {
  int storey = 0;
  int side = 1;
  double from_x_m = 0.0;
  double to_x_m = 0.0;
  double door_x_m = 0.0;
  std::uint64_t seed = 0;
  double floor_m() const { return storey * kStorey_m; }
};

struct IndoorPlan {
  double length_m = 0.0;
  std::vector<Room> rooms;
};

/// A stairwell, from the outer wall: landing, flights side by side, the floor before them.
constexpr double kLanding_m = 1.3;
constexpr int kStepsOfFlight = 9;
constexpr double kTread_m = 0.29;
constexpr double kRise_m = 0.5 * kStorey_m / kStepsOfFlight;
constexpr double kFlightEnd_m = kLanding_m + kStepsOfFlight * kTread_m;
constexpr double kStairwell_m = kFlightEnd_m + 1.3;
constexpr double kStairwellHalfWidth_m = 1.4;

IndoorPlan make_indoor_plan(std::uint64_t seed);

/// The middle of the free part of a room.
Eigen::Vector2d middle_of(const Room& room);
constexpr double kFreeRadius_m = 1.7;

/// A route on foot: round after round up one stairwell and down the other, with visits to some
/// rooms. Points on the floor, joined by straight lines; a longer route begins with the shorter
/// one.
std::vector<Eigen::Vector3d> indoor_route(const IndoorPlan& plan, std::uint64_t seed,
                                          double min_length_m);

/// Walls with doors and windows, floors, stairs, and the furniture of rooms and corridors.
TriangleMesh make_indoor_mesh(const IndoorPlan& plan);

}  // namespace hqslam::sim
