#include "indoor_plan.h"

#include <algorithm>
#include <cmath>

#include "random.h"

namespace hqslam::sim {

namespace {

void add_rooms(IndoorPlan& plan, int storey, int side, std::uint64_t seed) {
  Random random(seed);
  const double end_m = plan.length_m - kStairwell_m;
  double from_m = kStairwell_m;
  while (end_m - from_m > 1.0) {
    double to_m = std::min(end_m, from_m + random.uniform(4.4, 9.0));
    if (end_m - to_m < 4.4) to_m = end_m;
    const double door_m = random.uniform(from_m + 2.1, to_m - 2.1);
    plan.rooms.push_back({storey, side, from_m, to_m, door_m, random.bits()});
    from_m = to_m;
  }
}

class RouteMaker {
 public:
  RouteMaker(const IndoorPlan& plan, std::uint64_t seed) : plan_(plan), random_(seed) {
    go_to({0.5 * plan.length_m, 0.0, 0.0});
  }

  std::vector<Eigen::Vector3d> make(double min_length_m) {
    bool low_end_first = random_.chance(0.5);
    while (length_m_ < min_length_m) {
      go_round(low_end_first);
      const bool turn = random_.chance(0.4);
      if (!turn) continue;
      // People do not turn on the spot: into a room ahead and out again.
      visit(next_room(low_end_first ? -1.0 : 1.0));
      low_end_first = !low_end_first;
    }
    return route_;
  }

 private:
  void go_to(const Eigen::Vector3d& point_m) {
    if (!route_.empty()) length_m_ += (point_m - route_.back()).norm();
    route_.push_back(point_m);
  }

  /// From the middle of the lower corridor up one stairwell and down the other, back to the middle.
  void go_round(bool low_end_first) {
    const double low_m = kStairwell_m + 0.3;
    const double high_m = plan_.length_m - low_m;
    walk_corridor(0, low_end_first ? low_m : high_m);
    take_stairs(low_end_first, true);
    walk_corridor(1, low_end_first ? high_m : low_m);
    take_stairs(!low_end_first, false);
    walk_corridor(0, 0.5 * plan_.length_m);
  }

  /// From here along the corridor, with visits to some of the rooms.
  void walk_corridor(int storey, double to_x_m) {
    const double from_x_m = route_.back().x();
    std::vector<Room> passed;
    for (const Room& room : plan_.rooms) {
      const bool between = (room.door_x_m - from_x_m) * (room.door_x_m - to_x_m) < 0.0;
      if (room.storey == storey && between) passed.push_back(room);
    }
    std::ranges::sort(passed, {},
                      [&](const Room& room) { return std::abs(room.door_x_m - from_x_m); });
    for (const Room& room : passed) {
      if (random_.chance(0.25)) visit(room);
    }
    go_to({to_x_m, 0.0, storey * kStorey_m});
  }

  /// In by the door, once around the middle, out again.
  void visit(const Room& room) {
    const double z_m = room.floor_m();
    const Eigen::Vector2d middle_m = middle_of(room);
    const auto at = [&](double along_m, double inwards_m) {
      go_to({middle_m.x() + along_m, middle_m.y() + room.side * inwards_m, z_m});
    };
    go_to({middle_m.x(), 0.0, z_m});
    at(0.0, -1.2);
    at(0.9, 0.0);
    at(0.0, 0.9);
    at(-0.9, 0.0);
    at(0.0, -1.2);
    go_to({middle_m.x(), 0.0, z_m});
  }

  void take_stairs(bool at_low_end, bool up) {
    constexpr double kMiddle_m = 0.5 * kStairwellHalfWidth_m;
    constexpr double kHalfway_m = 0.5 * kStorey_m;
    std::vector<Eigen::Vector3d> points = {
        {kFlightEnd_m + 0.5, -kMiddle_m, 0.0},     {kFlightEnd_m, -kMiddle_m, 0.0},
        {kLanding_m, -kMiddle_m, kHalfway_m},      {0.5 * kLanding_m, -kMiddle_m, kHalfway_m},
        {0.5 * kLanding_m, kMiddle_m, kHalfway_m}, {kLanding_m, kMiddle_m, kHalfway_m},
        {kFlightEnd_m, kMiddle_m, kStorey_m},      {kFlightEnd_m + 0.5, kMiddle_m, kStorey_m},
        {kStairwell_m + 0.3, 0.0, kStorey_m},
    };
    if (!up) {
      points.pop_back();
      std::ranges::reverse(points);
      points.emplace_back(kStairwell_m + 0.3, 0.0, 0.0);
    }
    for (const Eigen::Vector3d& point : points) {
      go_to({at_low_end ? point.x() : plan_.length_m - point.x(), point.y(), point.z()});
    }
  }

  /// The next room ahead of the middle of the lower corridor; direction: 1 along x, -1 against it.
  const Room& next_room(double direction) const {
    const auto ahead_m = [&](const Room& room) {
      const double away_m = direction * (room.door_x_m - 0.5 * plan_.length_m);
      return room.storey == 0 && away_m > 0.5 ? away_m : plan_.length_m;
    };
    return *std::ranges::min_element(plan_.rooms, {}, ahead_m);
  }

  const IndoorPlan& plan_;
  Random random_;
  std::vector<Eigen::Vector3d> route_;
  double length_m_ = 0.0;
};

}  // namespace

IndoorPlan make_indoor_plan(std::uint64_t seed) {
  Random random(seed);
  IndoorPlan plan;
  plan.length_m = random.uniform(40.0, 60.0);
  for (int storey = 0; storey < kStoreys; ++storey) {
    for (const int side : {-1, 1}) add_rooms(plan, storey, side, random.bits());
  }
  return plan;
}

Eigen::Vector2d middle_of(const Room& room) {
  return {room.door_x_m, room.side * (kCorridorHalfWidth_m + kWall_m + 2.7)};
}

std::vector<Eigen::Vector3d> indoor_route(const IndoorPlan& plan, std::uint64_t seed,
                                          double min_length_m) {
  return RouteMaker(plan, seed).make(min_length_m);
}

}  // namespace hqslam::sim
