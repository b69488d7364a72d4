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

class LaneMaker {
 public:
  LaneMaker(const Layout& layout, const std::vector<Crossing>& route, const DriverStyle& style,
            std::uint64_t seed)
      : layout_(layout), route_(route), style_(style), seed_(seed) {}

  std::vector<LanePoint> make() {
    // Start on the first stretch, clear of the crossing.
    const Eigen::Vector2d direction = direction_of(0);
    at_ = sheet(route_[0]) + street_of(0).lane_offset_m * right_of(direction) +
          style_.start_m * direction;
    limit_mps_ = draw_limit(0);
    add(at_);
    for (std::size_t crossing = 1; crossing + 1 < route_.size(); ++crossing) cross(crossing);
    return lane_;
  }

 private:
  Eigen::Vector2d sheet(const Crossing& crossing) const {
    return {layout_.streets[0][crossing.x()].position_m,
            layout_.streets[1][crossing.y()].position_m};
  }
  Eigen::Vector2d direction_of(std::size_t way) const {
    return (route_[way + 1] - route_[way]).cast<double>();
  }
  /// The street that way `way` (from crossing `way` to the next) follows.
  const Street& street_of(std::size_t way) const {
    const int axis = route_[way + 1].x() == route_[way].x() ? 0 : 1;
    return layout_.streets[axis][route_[way][axis]];
  }
  double draw_limit(std::size_t way) const {
    return style_.min_limit_mps +
           (style_.max_limit_mps - style_.min_limit_mps) * uniform_of(seed_of(seed_, 1, way));
  }

  void add(const Eigen::Vector2d& sheet_m) {
    lane_.push_back({layout_.plane(sheet_m), limit_mps_});
    at_ = sheet_m;
  }

  void add_line(const Eigen::Vector2d& to) {
    const Eigen::Vector2d from = at_;
    const int count = steps((to - from).norm(), kStep_m);
    for (int k = 1; k <= count; ++k) add(from + (to - from) * (static_cast<double>(k) / count));
  }

  /// A quarter circle from here to `to`, tangent to both directions.
  void add_quarter(const Eigen::Vector2d& to, const Eigen::Vector2d& in,
                   const Eigen::Vector2d& out) {
    const Eigen::Vector2d from = at_;
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
    const Eigen::Vector2d lane_middle = sheet(route_[crossing]) + from.lane_offset_m * right_of(in);
    const bool straight = in.dot(out) > 0.5;
    const int axis = std::abs(in.x()) > 0.5 ? 0 : 1;
    const Street& crossed = layout_.streets[axis][route_[crossing][axis]];
    add_line(lane_middle - (crossed.half_width_m + 3.0) * in);
    if (uniform_of(seed_of(seed_, 2, crossing)) < style_.stop_share) {
      lane_.back().stop_s = 1.5 + 5.0 * uniform_of(seed_of(seed_, 3, crossing));
    }
    if (straight) {
      add_line(lane_middle);
      limit_mps_ = draw_limit(crossing);
      return;
    }
    // The lanes' lines meet here.
    const Eigen::Vector2d corner = lane_middle + to.lane_offset_m * right_of(out);
    const bool right = right_of(in).dot(out) > 0.5;
    const double radius_m = right ? kRightTurnRadius_m : kLeftTurnRadius_m;
    const Eigen::Vector2d turn_from = corner - radius_m * in;
    if ((turn_from - at_).dot(in) > 0.0) add_line(turn_from);
    // A stop line close to the corner makes for a tighter turn.
    const double left_m = (corner - at_).dot(in);
    limit_mps_ = draw_limit(crossing);
    add_quarter(corner + left_m * out, in, out);
  }

  const Layout& layout_;
  const std::vector<Crossing>& route_;
  const DriverStyle& style_;
  std::uint64_t seed_;
  std::vector<LanePoint> lane_;
  Eigen::Vector2d at_ = Eigen::Vector2d::Zero();
  double limit_mps_ = 0.0;
};

}  // namespace

std::vector<LanePoint> lane_along(const Layout& layout, const std::vector<Crossing>& route,
                                  const DriverStyle& style, std::uint64_t seed) {
  return LaneMaker(layout, route, style, seed).make();
}

}  // namespace hqslam::sim
