#include "lane.h"

#include <cmath>
#include <numbers>

#include "mesh.h"
#include "random.h"

namespace hqslam::sim {

namespace {

constexpr double kStep_m = 0.5;
constexpr double kRightTurnRadius_m = 6.5;
constexpr double kLeftTurnRadius_m = 9.0;

Eigen::Vector2d right_of(const Eigen::Vector2d& direction) {
  return {direction.y(), -direction.x()};
}

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
  Eigen::Vector2d direction_of(std::size_t way) const {
    return (route[way + 1] - route[way]).cast<double>();
  }
  /// The street that way `way` (from crossing `way` to the next) follows.
  const Street& street_of(std::size_t way) const {
    const int axis = route[way + 1].x() == route[way].x() ? 0 : 1;
    return layout.streets[axis][route[way][axis]];
  }
  double draw_limit(std::size_t way) const {
    return style.min_limit_mps +
           (style.max_limit_mps - style.min_limit_mps) * uniform_of(seed_of(seed, 1, way));
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

std::vector<LanePoint> lane_along(const Layout& layout, const std::vector<Crossing>& route,
                                  const DriverStyle& style, std::uint64_t seed) {
  return LaneMaker{layout, route, style, seed}.make();
}

}  // namespace hqslam::sim
