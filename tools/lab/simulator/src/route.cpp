#include "route.h"

#include <array>
#include <cmath>
#include <numbers>

#include "mesh.h"
#include "random.h"

namespace hqslam::sim {

namespace {

using Direction = Eigen::Vector2i;

template <typename Vector>
Vector right_of(const Vector& direction) {
  return {direction.y(), -direction.x()};
}
Direction left_of(const Direction& direction) { return -right_of(direction); }

/// A route as it is being planned.
struct Route {
  const Layout& layout;
  std::vector<Crossing> crossings;
  double length_m = 0.0;

  const Crossing& here() const { return crossings.back(); }
  void step(const Direction& direction) {
    const Crossing from = here();
    const Crossing to = from + direction;
    for (int axis = 0; axis < 2; ++axis) {
      length_m += std::abs(layout.streets[axis][to[axis]].position_m -
                           layout.streets[axis][from[axis]].position_m);
    }
    crossings.push_back(to);
  }
};

struct CircuitPlanner {
  const DriverStyle& style;
  Random random;
  Route route;
  Direction direction{1, 0};
  std::set<std::array<int, 4>> driven{};  ///< from one crossing to another

  std::vector<Crossing> plan(double min_length_m) {
    step(direction);
    while (route.length_m < min_length_m) {
      if (!drive_circuit()) wander();
      for (int stretches = random.below(3); stretches > 0; --stretches) wander();
    }
    return route.crossings;
  }

  std::array<Direction, 3> onward() const {
    return {direction, left_of(direction), right_of(direction)};
  }

  bool open(const Crossing& from, const Direction& towards) const {
    const Crossing to = from + towards;
    for (int axis = 0; axis < 2; ++axis) {
      const int count = static_cast<int>(route.layout.streets[axis].size());
      if (to[axis] < 0 || to[axis] >= count) return false;
    }
    // Only streets of axis 0 have closed stretches; to drive along one changes y alone.
    return towards.x() != 0 ||
           !route.layout.closed.contains({from.x(), std::min(from.y(), to.y())});
  }

  void step(const Direction& towards) {
    const Crossing from = route.here();
    route.step(towards);
    driven.insert({from.x(), from.y(), route.here().x(), route.here().y()});
    direction = towards;
  }

  /// Once around a rectangle that begins here, then its first stretch again.
  bool drive_circuit() {
    for (int attempt = 0; attempt < 60; ++attempt) {
      const bool left = random.chance(0.5);
      Direction side_direction = onward()[random.below(3)];
      const std::array<int, 2> size = {1 + random.below(style.max_circuit_blocks),
                                       1 + random.below(style.max_circuit_blocks)};
      std::vector<Direction> directions;
      for (std::size_t side = 0; side < 4; ++side) {
        directions.insert(directions.end(), static_cast<std::size_t>(size[side % 2]),
                          side_direction);
        side_direction = left ? left_of(side_direction) : right_of(side_direction);
      }
      directions.push_back(directions.front());
      if (!passable(directions)) continue;
      for (const Direction& towards : directions) step(towards);
      return true;
    }
    return false;
  }

  bool passable(const std::vector<Direction>& directions) const {
    Crossing at = route.here();
    for (const Direction& towards : directions) {
      if (!open(at, towards)) return false;
      at += towards;
    }
    return true;
  }

  /// One stretch on, never back.
  void wander() {
    const Crossing& here = route.here();
    std::vector<Direction> possible;
    std::vector<Direction> driven_backwards;
    for (const Direction& towards : onward()) {
      if (!open(here, towards)) continue;
      possible.push_back(towards);
      const Crossing to = here + towards;
      if (driven.contains({to.x(), to.y(), here.x(), here.y()})) {
        driven_backwards.push_back(towards);
      }
    }
    const auto& choice =
        !driven_backwards.empty() && random.chance(0.6) ? driven_backwards : possible;
    step(choice[static_cast<std::size_t>(random.below(static_cast<int>(choice.size())))]);
  }
};

/// The outermost streets in alternating directions, joined by a street across the middle:
///
///   +---Q---+    P, right, Q, left, P: counter-clockwise; right to Q, down to P;
///   |   |   |    P, left, Q, right, P: clockwise; left to Q, down to P.
///   +---P---+
std::vector<Crossing> plan_loop_both_ways(const Layout& layout, double min_length_m) {
  const Crossing last(static_cast<int>(layout.streets[0].size()) - 1,
                      static_cast<int>(layout.streets[1].size()) - 1);
  const Crossing low(last.x() / 2, 0);
  const Crossing high(last.x() / 2, last.y());
  Route route{layout, {low}};
  const auto go_to = [&](const Crossing& to) {
    const Direction step = (to - route.here()).cwiseSign();
    while (route.here() != to) route.step(step);
  };
  // By the outer street `side` of axis 0.
  const auto go_around = [&](int side, const Crossing& to) {
    go_to({side, route.here().y()});
    go_to({side, to.y()});
    go_to(to);
  };
  int side = last.x();
  while (route.length_m < min_length_m) {
    go_around(side, high);
    go_around(last.x() - side, low);
    go_around(side, high);
    go_to(low);
    side = last.x() - side;
  }
  return route.crossings;
}

constexpr double kStep_m = 0.5;
constexpr double kRightTurnRadius_m = 6.5;
constexpr double kLeftTurnRadius_m = 9.0;

struct LaneMaker {
  const Layout& layout;
  const std::vector<Crossing>& route;
  const DriverStyle& style;
  std::uint64_t seed;
  std::vector<LanePoint> lane{};
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
  double limit_mps = 0.0;

  std::vector<LanePoint> make() {
    // Start on the first stretch, clear of the crossing.
    const Eigen::Vector2d direction = direction_of(0);
    at_m = sheet(route[0]) + street_of(0).lane_offset_m * right_of(direction) +
           style.start_m * direction;
    limit_mps = draw_limit(0);
    add(at_m);
    for (std::size_t crossing = 1; crossing + 1 < route.size(); ++crossing) cross(crossing);
    return lane;
  }

  Eigen::Vector2d sheet(const Crossing& crossing) const {
    return {layout.streets[0][crossing.x()].position_m, layout.streets[1][crossing.y()].position_m};
  }
  Eigen::Vector2d direction_of(std::size_t stretch) const {
    return (route[stretch + 1] - route[stretch]).cast<double>();
  }
  /// The street of a stretch, which leads from the crossing of the same number to the next.
  const Street& street_of(std::size_t stretch) const {
    const int axis = route[stretch + 1].x() == route[stretch].x() ? 0 : 1;
    return layout.streets[axis][route[stretch][axis]];
  }
  double draw_limit(std::size_t stretch) const {
    return style.min_limit_mps +
           (style.max_limit_mps - style.min_limit_mps) * uniform_of(seed_of(seed, 1, stretch));
  }

  void add(const Eigen::Vector2d& sheet_m) {
    lane.push_back({layout.plane(sheet_m), limit_mps});
    at_m = sheet_m;
  }

  void add_line(const Eigen::Vector2d& to) {
    const Eigen::Vector2d from = at_m;
    const int count = steps((to - from).norm(), kStep_m);
    for (int k = 1; k <= count; ++k) add(from + (to - from) * (static_cast<double>(k) / count));
  }

  /// A quarter circle from here to `to`, tangent to both directions.
  void add_quarter(const Eigen::Vector2d& to, const Eigen::Vector2d& in,
                   const Eigen::Vector2d& out) {
    const Eigen::Vector2d from = at_m;
    const double radius_m = std::abs((to - from).dot(in));
    const Eigen::Vector2d centre = from + radius_m * out;
    const int count = static_cast<int>(std::ceil(radius_m * std::numbers::pi / 2.0 / kStep_m));
    for (int k = 1; k <= count; ++k) {
      const double angle_rad = 0.5 * std::numbers::pi * k / count;
      add(centre + radius_m * (std::sin(angle_rad) * in - std::cos(angle_rad) * out));
    }
  }

  /// Up to a crossing and around its corner.
  void cross(std::size_t crossing) {
    const Eigen::Vector2d in = direction_of(crossing - 1);
    const Eigen::Vector2d out = direction_of(crossing);
    const Street& from = street_of(crossing - 1);
    const Street& to = street_of(crossing);
    const Eigen::Vector2d lane_middle = sheet(route[crossing]) + from.lane_offset_m * right_of(in);
    const bool straight = in.dot(out) > 0.5;
    const int axis = std::abs(in.x()) > 0.5 ? 0 : 1;
    const Street& crossed = layout.streets[axis][route[crossing][axis]];
    add_line(lane_middle - (crossed.half_width_m + 3.0) * in);
    if (uniform_of(seed_of(seed, 2, crossing)) < style.stop_share) {
      lane.back().stop_s = 1.5 + 5.0 * uniform_of(seed_of(seed, 3, crossing));
    }
    if (straight) {
      add_line(lane_middle);
      limit_mps = draw_limit(crossing);
      return;
    }
    // The lanes' lines meet here.
    const Eigen::Vector2d corner = lane_middle + to.lane_offset_m * right_of(out);
    const bool right = right_of(in).dot(out) > 0.5;
    const double radius_m = right ? kRightTurnRadius_m : kLeftTurnRadius_m;
    const Eigen::Vector2d turn_from = corner - radius_m * in;
    if ((turn_from - at_m).dot(in) > 0.0) add_line(turn_from);
    // A stop line close to the corner makes for a tighter turn.
    const double left_m = (corner - at_m).dot(in);
    limit_mps = draw_limit(crossing);
    add_quarter(corner + left_m * out, in, out);
  }
};

}  // namespace

std::vector<Crossing> make_route(const Layout& layout, const DriverStyle& style, std::uint64_t seed,
                                 double min_length_m) {
  if (style.route == RouteKind::kLoopBothWays) return plan_loop_both_ways(layout, min_length_m);
  const Crossing middle(static_cast<int>(layout.streets[0].size()) / 2,
                        static_cast<int>(layout.streets[1].size()) / 2);
  return CircuitPlanner{style, Random(seed), {layout, {middle}}}.plan(min_length_m);
}

std::vector<LanePoint> lane_along(const Layout& layout, const std::vector<Crossing>& route,
                                  const DriverStyle& style, std::uint64_t seed) {
  return LaneMaker{layout, route, style, seed}.make();
}

}  // namespace hqslam::sim
