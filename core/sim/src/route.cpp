#include "route.h"

#include <array>
#include <set>

#include "random.h"

namespace hqslam::sim {

namespace {

using Direction = Eigen::Vector2i;

Direction left_of(const Direction& direction) { return {-direction.y(), direction.x()}; }

using Way = std::array<int, 4>;  ///< from one crossing to another
Way way_between(const Crossing& from, const Crossing& to) {
  return {from.x(), from.y(), to.x(), to.y()};
}

double length_between_m(const Layout& layout, const Crossing& from, const Crossing& to) {
  double length_m = 0.0;
  for (int axis = 0; axis < 2; ++axis) {
    length_m += std::abs(layout.streets[axis][to[axis]].position_m -
                         layout.streets[axis][from[axis]].position_m);
  }
  return length_m;
}

class Planner {
 public:
  Planner(const Layout& layout, const DriverStyle& style, std::uint64_t seed)
      : layout_(layout), style_(style), random_(seed) {
    const Crossing middle(static_cast<int>(layout.streets[0].size()) / 2,
                          static_cast<int>(layout.streets[1].size()) / 2);
    route_.push_back(middle);
    direction_ = {1, 0};
    step(direction_);
  }

  std::vector<Crossing> plan(double min_length_m) {
    while (length_m_ < min_length_m) {
      if (!drive_circuit()) wander();
      const int ways = random_.below(3);
      for (int way = 0; way < ways; ++way) wander();
    }
    return route_;
  }

 private:
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
    const Crossing from = route_.back();
    const Crossing to = from + direction;
    driven_.insert(way_between(from, to));
    length_m_ += length_between_m(layout_, from, to);
    route_.push_back(to);
    direction_ = direction;
  }

  /// Once around a rectangle that begins here, then its first stretch again.
  bool drive_circuit() {
    for (int attempt = 0; attempt < 60; ++attempt) {
      const bool left = random_.chance(0.5);
      Direction direction = direction_;
      const int turn = random_.below(3);
      if (turn == 1) direction = left_of(direction);
      if (turn == 2) direction = -left_of(direction);
      const std::array<int, 2> size = {1 + random_.below(style_.max_circuit_blocks),
                                       1 + random_.below(style_.max_circuit_blocks)};
      std::vector<Direction> ways;
      for (std::size_t side = 0; side < 4; ++side) {
        ways.insert(ways.end(), static_cast<std::size_t>(size[side % 2]), direction);
        direction = left ? left_of(direction) : Direction(-left_of(direction));
      }
      ways.push_back(ways.front());
      if (!passable(ways)) continue;
      for (const Direction& way : ways) step(way);
      return true;
    }
    return false;
  }

  bool passable(const std::vector<Direction>& ways) const {
    Crossing at = route_.back();
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
    for (const Direction& way :
         {direction_, left_of(direction_), Direction(-left_of(direction_))}) {
      if (!open(route_.back(), way)) continue;
      possible.push_back(way);
      if (driven_.contains(way_between(route_.back() + way, route_.back())))
        driven_backwards.push_back(way);
    }
    const auto& choice =
        !driven_backwards.empty() && random_.chance(0.6) ? driven_backwards : possible;
    step(choice[static_cast<std::size_t>(random_.below(static_cast<int>(choice.size())))]);
  }

  const Layout& layout_;
  const DriverStyle& style_;
  Random random_;
  std::vector<Crossing> route_;
  Direction direction_;
  double length_m_ = 0.0;
  std::set<Way> driven_;
};

/// The outermost streets, then the same the other way round, and so on. A street across the middle
/// joins the two:
///
///   +---Q---+    P, right, Q, left, P: counter-clockwise; right to Q, down to P;
///   |   |   |    P, left, Q, right, P: clockwise; left to Q, down to P.
///   +---P---+
class LoopBothWays {
 public:
  explicit LoopBothWays(const Layout& layout)
      : layout_(layout),
        last_(static_cast<int>(layout.streets[0].size()) - 1,
              static_cast<int>(layout.streets[1].size()) - 1),
        low_(last_.x() / 2, 0),
        high_(last_.x() / 2, last_.y()),
        route_{low_} {}

  std::vector<Crossing> plan(double min_length_m) {
    int side = last_.x();
    while (length_m_ < min_length_m) {
      const int other_side = last_.x() - side;
      go_around(low_, side, high_);
      go_around(high_, other_side, low_);
      go_around(low_, side, high_);
      go_to(low_);
      side = other_side;
    }
    return route_;
  }

 private:
  /// By the outer street `side` of axis 0.
  void go_around(const Crossing& from, int side, const Crossing& to) {
    go_to({side, from.y()});
    go_to({side, to.y()});
    go_to(to);
  }

  void go_to(const Crossing& to) {
    const Crossing step = (to - route_.back()).cwiseSign();
    while (route_.back() != to) {
      const Crossing from = route_.back();
      route_.push_back(from + step);
      length_m_ += length_between_m(layout_, from, route_.back());
    }
  }

  const Layout& layout_;
  const Crossing last_;
  const Crossing low_;
  const Crossing high_;
  std::vector<Crossing> route_;
  double length_m_ = 0.0;
};

}  // namespace

std::vector<Crossing> make_route(const Layout& layout, const DriverStyle& style, std::uint64_t seed,
                                 double min_length_m) {
  if (style.route == RouteKind::kLoopBothWays) return LoopBothWays(layout).plan(min_length_m);
  return Planner(layout, style, seed).plan(min_length_m);
}

}  // namespace hqslam::sim
