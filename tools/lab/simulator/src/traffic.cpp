#include "traffic.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "city.h"

namespace hqslam::sim {

namespace {

constexpr double kReach_m = 95.0;
constexpr double kClearance_m = 6.0;
constexpr double kAlways_s = std::numeric_limits<double>::infinity();

/// The place on the edge of a rectangle, `along_m` counter-clockwise from its lowest corner.
Eigen::Vector2d place_around(const Eigen::AlignedBox2d& sheet_m, double along_m) {
  const double around_m = 2.0 * sheet_m.sizes().sum();
  along_m = std::fmod(along_m, around_m);
  if (along_m < 0.0) along_m += around_m;
  const auto sides = sides_of(sheet_m);
  std::size_t k = 0;
  while (k < 3 && along_m >= sides[k].length_m) along_m -= sides[k++].length_m;
  return sides[k].at(along_m, 0.0);
}

}  // namespace

Traffic::Traffic(const Layout& layout, const DriveStyle& style, const DriverPath& ego,
                 std::uint64_t seed, double until_s)
    : layout_(layout), ego_(ego), car_ahead_(style.driver.follows_car) {
  add_trips(style, seed_of(seed, 1), until_s);
  add_walkers(style.city, seed_of(seed, 2));
}

void Traffic::add_trips(const DriveStyle& style, std::uint64_t seed, double until_s) {
  const double interval_s = style.city.seconds_between_cars;
  if (!std::isfinite(interval_s)) return;
  for (int axis = 0; axis < 2; ++axis) {
    for (std::size_t street = 0; street < layout_.streets[axis].size(); ++street) {
      // No car drives on a street with a stretch that is built over.
      const bool blocked = std::ranges::any_of(layout_.closed, [&](const Stretch& stretch) {
        return axis == 0 && stretch.street == static_cast<int>(street);
      });
      if (blocked) continue;
      for (const double direction : {-1.0, 1.0}) {
        const auto lane_seed = seed_of(
            seed, 4 * street + 2 * static_cast<std::uint64_t>(axis) + (direction > 0.0 ? 1 : 0));
        add_trips_on(layout_.streets[axis][street], axis, direction, interval_s, until_s,
                     Random(lane_seed));
      }
    }
  }
}

void Traffic::add_trips_on(const Street& street, int axis, double direction, double interval_s,
                           double until_s, Random random) {
  const double low_m = layout_.rim_m.min()[1 - axis];
  const double high_m = layout_.rim_m.max()[1 - axis];
  const Eigen::Vector2d along = direction * Eigen::Vector2d::Unit(1 - axis);
  // On the right of its direction: +u has -v on its right, +v has +u.
  const double right = axis == 0 ? direction : -direction;
  const double lane_m = street.position_m + right * street.lane_offset_m;
  const double speed_mps = random.uniform(7.5, 12.5);
  double start_s = -(high_m - low_m) / speed_mps;
  while (start_s < until_s) {
    start_s += interval_s * random.uniform(0.35, 1.65);
    const auto sheet_at = [=, from_m = direction > 0.0 ? low_m : high_m](double time_s) {
      Eigen::Vector2d sheet_m;
      sheet_m[axis] = lane_m;
      sheet_m[1 - axis] = from_m + direction * speed_mps * (time_s - start_s);
      return sheet_m;
    };
    const auto pose_at = [&layout = layout_, sheet_at, along](double time_s) {
      const Eigen::Vector2d sheet_m = sheet_at(time_s);
      return Eigen::Affine3d(
          layout.terrain.frame(layout.plane(sheet_m), layout.heading_rad(sheet_m, along)));
    };
    const int car = kFirstCar + random.below(kCarBodies);
    const double end_s = start_s + (high_m - low_m) / speed_mps;
    const Actor trip{car, random.shade(), start_s, end_s, sheet_at, pose_at};
    if (!meets_ego(trip)) actors_.push_back(trip);
  }
}

void Traffic::add_walkers(const CityStyle& style, std::uint64_t seed) {
  for (const Block& block : layout_.blocks) {
    if (!has_sidewalk(block.kind)) continue;
    Random random(seed_of(seed, block.seed));
    const bool busy = block.kind != BlockKind::kOpenLand && block.kind != BlockKind::kWalled;
    const int count = busy ? random.below(2 * style.pedestrians_per_block + 1) : random.below(2);
    for (int k = 0; k < count; ++k) {
      const double inset_m = random.uniform(1.4, 2.4);
      const Eigen::AlignedBox2d around(block.sheet_m.min().array() + inset_m,
                                       block.sheet_m.max().array() - inset_m);
      const double walk_mps = random.uniform(0.8, 1.6);
      const double speed_mps = random.chance(0.5) ? walk_mps : -walk_mps;
      const double start_m = random.uniform(0.0, 2.0 * around.sizes().sum());
      const auto sheet_at = [=](double time_s) {
        return place_around(around, start_m + speed_mps * time_s);
      };
      const auto pose_at = [&layout = layout_, sheet_at](double time_s) {
        const Eigen::Vector2d here = layout.plane(sheet_at(time_s));
        const Eigen::Vector2d step = layout.plane(sheet_at(time_s + 0.5)) - here;
        return Eigen::Affine3d(upright_frame(layout.terrain.ground(here, kKerbHeight_m),
                                             std::atan2(step.y(), step.x())));
      };
      const int body = kFirstWalker + random.below(kWalkerBodies);
      actors_.push_back({body, random.shade(), -kAlways_s, kAlways_s, sheet_at, pose_at});
    }
  }
}

bool Traffic::meets_ego(const Actor& car) const {
  constexpr double kStep_s = 0.25;
  for (double time_s = std::max(0.0, car.start_s); time_s < car.end_s; time_s += kStep_s) {
    const Eigen::Vector2d plane_m = layout_.plane(car.sheet_at(time_s));
    const PathState ego = ego_.at_time(time_s);
    const Eigen::Vector2d away = plane_m - ego.plane_m;
    const Eigen::Vector2d forward(std::cos(ego.heading_rad), std::sin(ego.heading_rad));
    const double ahead_m = std::abs(away.dot(forward));
    const double aside_m = std::abs(away.dot(Eigen::Vector2d(-forward.y(), forward.x())));
    // Oncoming cars pass at the width of a lane; behind and ahead there must be more room.
    if (ahead_m < kClearance_m && aside_m < 2.6) return true;
  }
  return false;
}

Eigen::Affine3d Traffic::pose_of_car_ahead(double time_s) const {
  const double ego_m = ego_.at_time(time_s).along_m;
  const PathState ahead = ego_.at_distance(ego_m + 24.0 + 8.0 * std::sin(ego_m / 90.0));
  return Eigen::Affine3d(layout_.terrain.frame(ahead.plane_m, ahead.heading_rad));
}

std::vector<ActorMotion> Traffic::actors(double from_s, double to_s,
                                         const Eigen::Vector2d& plane_m) const {
  std::vector<std::pair<double, ActorMotion>> near;
  for (const Actor& who : actors_) {
    if (from_s < who.start_s || to_s > who.end_s) continue;
    const double away_m = (layout_.plane(who.sheet_at(from_s)) - plane_m).norm();
    if (away_m >= kReach_m) continue;
    near.push_back({away_m, {who.prototype, who.pose_at(from_s), who.pose_at(to_s), who.shade}});
  }
  std::ranges::stable_sort(near, [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<ActorMotion> actors;
  if (car_ahead_) {
    actors.push_back(
        {kFirstCar + kCarBodies - 1, pose_of_car_ahead(from_s), pose_of_car_ahead(to_s), 150});
  }
  for (auto& [away_m, actor] : near) actors.push_back(actor);
  return actors;
}

}  // namespace hqslam::sim
