#include "traffic.h"

#include <algorithm>
#include <cmath>

#include "city.h"
#include "random.h"

namespace hqslam::sim {

namespace {

constexpr double kReach_m = 95.0;
constexpr double kClearance_m = 6.0;

}  // namespace

Traffic::Traffic(const Layout& layout, const DriveStyle& style, const DriverPath& ego,
                 std::uint64_t seed, double until_s)
    : layout_(layout), ego_(ego), car_ahead_(style.driver.follows_car) {
  add_trips(style, seed_of(seed, 1), until_s);
  add_walkers(style.city, seed_of(seed, 2));
}

void Traffic::add_trips(const DriveStyle& style, std::uint64_t seed, double until_s) {
  if (!std::isfinite(style.city.seconds_between_cars)) return;
  for (int axis = 0; axis < 2; ++axis) {
    const double low_m = layout_.rim_m.min()[1 - axis];
    const double high_m = layout_.rim_m.max()[1 - axis];
    for (std::size_t street = 0; street < layout_.streets[axis].size(); ++street) {
      const Street& line = layout_.streets[axis][street];
      // No car drives on a street with a stretch that is built over.
      const bool blocked = std::ranges::any_of(layout_.closed, [&](const Stretch& stretch) {
        return axis == 0 && stretch.street == static_cast<int>(street);
      });
      if (blocked) continue;
      for (const double direction : {-1.0, 1.0}) {
        // On the right of its direction: +u has -v on its right, +v has +u.
        const double right = axis == 0 ? direction : -direction;
        Random random(seed_of(
            seed, 4 * street + 2 * static_cast<std::uint64_t>(axis) + (direction > 0.0 ? 1 : 0)));
        const double speed_mps = random.uniform(7.5, 12.5);
        double start_s = -(high_m - low_m) / speed_mps;
        while (start_s < until_s) {
          start_s += style.city.seconds_between_cars * random.uniform(0.35, 1.65);
          const double lane_m = line.position_m + right * line.lane_offset_m;
          const double from_m = direction > 0.0 ? low_m : high_m;
          const int car = kFirstCar + random.below(kCarBodies);
          const Trip trip{axis,    lane_m,    direction, from_m,        high_m - low_m,
                          start_s, speed_mps, car,       random.shade()};
          if (!meets_ego(trip)) trips_.push_back(trip);
        }
      }
    }
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
      walkers_.push_back({around, random.uniform(0.0, 2.0 * around.sizes().sum()), speed_mps,
                          kFirstWalker + random.below(kWalkerBodies), random.shade()});
    }
  }
}

bool Traffic::meets_ego(const Trip& trip) const {
  constexpr double kStep_s = 0.25;
  for (double time_s = std::max(0.0, trip.start_s); time_s < trip.end_s(); time_s += kStep_s) {
    const Eigen::Vector2d plane_m = layout_.plane(trip.sheet_at(time_s));
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

Eigen::Vector2d Traffic::Trip::sheet_at(double time_s) const {
  Eigen::Vector2d sheet_m;
  sheet_m[axis] = street_m;
  sheet_m[1 - axis] = from_m + direction * speed_mps * (time_s - start_s);
  return sheet_m;
}

Eigen::Vector2d Traffic::Walker::sheet_at(double time_s) const {
  const double around_m = 2.0 * around_sheet_m.sizes().sum();
  double along_m = std::fmod(start_m + speed_mps * time_s, around_m);
  if (along_m < 0.0) along_m += around_m;
  const auto sides = sides_of(around_sheet_m);
  std::size_t k = 0;
  while (k < 3 && along_m >= sides[k].length_m) along_m -= sides[k++].length_m;
  return sides[k].at(along_m, 0.0);
}

Eigen::Affine3d Traffic::pose_of(const Trip& trip, double time_s) const {
  const Eigen::Vector2d sheet_m = trip.sheet_at(time_s);
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();
  direction[1 - trip.axis] = trip.direction;
  return Eigen::Affine3d(
      layout_.terrain.frame(layout_.plane(sheet_m), layout_.heading_rad(sheet_m, direction)));
}

Eigen::Affine3d Traffic::pose_of(const Walker& walker, double time_s) const {
  const Eigen::Vector2d here = layout_.plane(walker.sheet_at(time_s));
  const Eigen::Vector2d step = layout_.plane(walker.sheet_at(time_s + 0.5)) - here;
  return Eigen::Affine3d(
      upright_frame(layout_.terrain.ground(here, kKerbHeight_m), std::atan2(step.y(), step.x())));
}

Eigen::Affine3d Traffic::pose_of_car_ahead(double time_s) const {
  const double ego_m = ego_.at_time(time_s).along_m;
  const PathState ahead = ego_.at_distance(ego_m + 24.0 + 8.0 * std::sin(ego_m / 90.0));
  return Eigen::Affine3d(layout_.terrain.frame(ahead.plane_m, ahead.heading_rad));
}

std::vector<ActorMotion> Traffic::actors(double from_s, double to_s,
                                         const Eigen::Vector2d& plane_m) const {
  std::vector<std::pair<double, ActorMotion>> near;
  const auto consider = [&](const auto& who) {
    const double away_m = (layout_.plane(who.sheet_at(from_s)) - plane_m).norm();
    if (away_m >= kReach_m) return;
    near.push_back({away_m, {who.prototype, pose_of(who, from_s), pose_of(who, to_s), who.shade}});
  };
  for (const Trip& trip : trips_) {
    if (from_s >= trip.start_s && to_s <= trip.end_s()) consider(trip);
  }
  for (const Walker& walker : walkers_) consider(walker);
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
