#include "route.h"

#include <array>
#include <set>

#include "random.h"

namespace hqslam::sim {

namespace {

using Direction = Eigen::Vector2i;

Direction left_of(const Direction& direction) { return {-direction.y(), direction.x()}; }
Direction right_of(const Direction& direction) { return {direction.y(), -direction.x()}; }

using Way = std::array<int, 4>;  ///< from one crossing to another
Way way_between(const Crossing& from, const Crossing& to) {
  return {from.x(), from.y(), to.x(), to.y()};
}

/// A route as it is being planned.
class Route {
 public:
  Route(const Layout& layout, const Crossing& start) : layout_(layout), crossings_{start} {}

  const Crossing& here() const { return crossings_.back(); }
  double length_m() const { return length_m_; }
  const std::vector<Crossing>& crossings() const { return crossings_; }

  void step(const Direction& direction) {
    const Crossing from = here();
    const Crossing to = from + direction;
    for (int axis = 0; axis < 2; ++axis) {
      length_m_ += std::abs(layout_.streets[axis][to[axis]].position_m -
                            layout_.streets[axis][from[axis]].position_m);
    }
    crossings_.push_back(to);
  }

 private:
  const Layout& layout_;
  std::vector<Crossing> crossings_;
  double length_m_ = 0.0;
};

class CircuitPlanner {
 public:
  CircuitPlanner(const Layout& layout, const DriverStyle& style, std::uint64_t seed)
      : layout_(layout),
        style_(style),
        random_(seed),
        route_(layout, {static_cast<int>(layout.streets[0].size()) / 2,
                        static_cast<int>(layout.streets[1].size()) / 2}) {
    step(direction_);
  }

  std::vector<Crossing> plan(double min_length_m) {
    while (route_.length_m() < min_length_m) {
      if (!drive_circuit()) wander();
      for (int ways = random_.below(3); ways > 0; --ways) wander();
    }
    return route_.crossings();
  }

 private:
  std::array<Direction, 3> onward() const {
    return {direction_, left_of(direction_), right_of(direction_)};
  }

  bool open(const Crossing& from, const Direction& direction) const {
    const Crossing to = from + direction;
    for (int axis = 0; axis < 2; ++axis) {
      const int count = static_cast<int>(layout_.streets[axis].size());
      if (to[axis] < 0 || to[axis] >= count) return false;
    }
    // Driving along axis 1 follows a street of axis 0 and the other way round.
    const int street_axis = direction.x() == 0 ? 0 : 1;
    const int along = 1 - street_axis;
    return !layout_.closed.contains(
        {street_axis, from[street_axis], std::min(from[along], to[along])});
  }

  void step(const Direction& direction) {
    driven_.insert(way_between(route_.here(), route_.here() + direction));
    route_.step(direction);
    direction_ = direction;
  }

  /// Once around a rectangle that begins here, then its first stretch again.
  bool drive_circuit() {
    for (int attempt = 0; attempt < 60; ++attempt) {
      const bool left = random_.chance(0.5);
      Direction direction = onward()[random_.below(3)];
      const std::array<int, 2> size = {1 + random_.below(style_.max_circuit_blocks),
                                       1 + random_.below(style_.max_circuit_blocks)};
      std::vector<Direction> ways;
      for (std::size_t side = 0; side < 4; ++side) {
        ways.insert(ways.end(), static_cast<std::size_t>(size[side % 2]), direction);
        direction = left ? left_of(direction) : right_of(direction);
      }
      ways.push_back(ways.front());
      if (!passable(ways)) continue;
      for (const Direction& way : ways) step(way);
      return true;
    }
    return false;
  }

  bool passable(const std::vector<Direction>& ways) const {
    Crossing at = route_.here();
    for (const Direction& way : ways) {
      if (!open(at, way)) return false;
      at += way;
    }
    return true;
  }

  /// One stretch on, never back.
  void wander() {
    std::vector<Direction> possible;
    std::vector<Direction> driven_backwards;
    for (const Direction& way : onward()) {
      if (!open(route_.here(), way)) continue;
      possible.push_back(way);
      if (driven_.contains(way_between(route_.here() + way, route_.here())))
        driven_backwards.push_back(way);
    }
    const auto& choice =
        !driven_backwards.empty() && random_.chance(0.6) ? driven_backwards : possible;
    step(choice[static_cast<std::size_t>(random_.below(static_cast<int>(choice.size())))]);
  }

  const Layout& layout_;
  const DriverStyle& style_;
  Random random_;
  Route route_;
  Direction direction_{1, 0};
  std::set<Way> driven_;
};

/// The outermost streets, then the same the other way round, and so on. A street across the middle
/// joins the two:
///
///   +---Q---+    P, right, Q, left, P: counter-clockwise; right to Q, down to P;
///   |   |   |    P, left, Q, right, P: clockwise; left to Q, down to P.
///   +---P---+
std::vector<Crossing> plan_loop_both_ways(const Layout& layout, double min_length_m) {
  const Crossing last(static_cast<int>(layout.streets[0].size()) - 1,
                      static_cast<int>(layout.streets[1].size()) - 1);
  const Crossing low(last.x() / 2, 0);
  const Crossing high(last.x() / 2, last.y());
  Route route(layout, low);
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
  while (route.length_m() < min_length_m) {
    go_around(side, high);
    go_around(last.x() - side, low);
    go_around(side, high);
    go_to(low);
    side = last.x() - side;
  }
  return route.crossings();
}

}  // namespace

std::vector<Crossing> make_route(const Layout& layout, const DriverStyle& style, std::uint64_t seed,
                                 double min_length_m) {
  if (style.route == RouteKind::kLoopBothWays) return plan_loop_both_ways(layout, min_length_m);
  return CircuitPlanner(layout, style, seed).plan(min_length_m);
}

}  // namespace hqslam::sim
