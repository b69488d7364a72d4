#include "scenario.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "b_spline.h"
#include "indoor_plan.h"
#include "random.h"

namespace hqslam::sim {

namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

/// Sway of a car with the sensor on its roof as a function of the distance s driven, so that a
/// standing car does not move and the pose is as smooth in time as the path:
///   roll, pitch, heave = sum_k a_k sin(w_k s + p_k),  2 pi / w_k about 47, 23, 13 and 8 m
class VehicleSway {
 public:
  VehicleSway(std::uint64_t seed, const SensorMount& mount) : mount_(mount) {
    constexpr std::array<double, 4> kWavelength_m = {47.0, 23.0, 13.0, 8.0};
    constexpr std::array<double, 3> kAmplitude = {0.0035, 0.0025, 0.008};  // radians, metres
    Random random(seed);
    for (std::size_t k = 0; k < kWavelength_m.size(); ++k) {
      const double size = std::sqrt(kWavelength_m[k] / kWavelength_m[0]);
      for (std::size_t part = 0; part < kAmplitude.size(); ++part) {
        waves_[part][k] = {kTurn_rad / (kWavelength_m[k] * random.uniform(0.85, 1.15)),
                           random.uniform(0.0, kTurn_rad), kAmplitude[part] * size};
      }
    }
  }

  Pose T_vehicle_sensor(double along_m) const {
    std::array<double, 3> sums{};
    for (std::size_t part = 0; part < sums.size(); ++part) {
      for (const Wave& wave : waves_[part]) {
        sums[part] +=
            wave.amplitude * std::sin(wave.wave_number_rad_per_m * along_m + wave.phase_rad);
      }
    }
    return pose_from_xyz_rpy({0.0, 0.0, mount_.sensor_height_m + sums[2]},
                             mount_.mount_roll_rad + sums[0], mount_.mount_pitch_rad + sums[1],
                             0.0);
  }

 private:
  struct Wave {
    double wave_number_rad_per_m;
    double phase_rad;
    double amplitude;
  };
  SensorMount mount_;
  std::array<std::array<Wave, 4>, 3> waves_;  ///< roll, pitch, heave
};

/// Motion of a sensor in the hand of a walker: roll, pitch and yaw of the style's sizes, and a rise
/// with every step.
///   angle(t) = A (0.85 + 0.15 sin(w_slow t + p_slow)) sin(w t + p),  2 pi / w = 0.95 to 1.05 s
class HandSway {
 public:
  HandSway(std::uint64_t seed, const HandStyle& style, const SensorMount& mount)
      : T_walker_hand_(pose_from_xyz_rpy({0.0, 0.0, mount.sensor_height_m}, 0.0, 0.0, 0.0)),
        T_hand_mount_(pose_from_xyz_rpy(Eigen::Vector3d::Zero(), mount.mount_roll_rad,
                                        mount.mount_pitch_rad, 0.0)) {
    const std::array<double, 5> amplitude = {style.swing_rad, style.swing_rad, style.turn_rad, 0.03,
                                             0.025};
    constexpr std::array<double, 5> kPerSecond = {1.0, 1.0, 0.5, 1.0, 2.0};
    Random random(seed);
    for (std::size_t k = 0; k < swings_.size(); ++k) {
      swings_[k] = {amplitude[k], kTurn_rad * kPerSecond[k] / random.uniform(0.95, 1.05),
                    random.uniform(0.0, kTurn_rad), random.uniform(0.0, kTurn_rad)};
    }
  }

  /// T_world_walker: the walker's feet, upright, x forward.
  Pose T_world_sensor(const Pose& T_world_walker, double time_s) const {
    const Pose T_hand_swung =
        pose_from_xyz_rpy({0.0, swings_[3].at(time_s), swings_[4].at(time_s)},
                          swings_[0].at(time_s), swings_[1].at(time_s), swings_[2].at(time_s));
    return T_world_walker * T_walker_hand_ * T_hand_swung * T_hand_mount_;
  }

 private:
  struct Swing {
    double amplitude;
    double frequency_rad_per_s;
    double phase_rad;
    double slow_phase_rad;
    double at(double time_s) const {
      const double size =
          0.85 + 0.15 * std::sin(0.11 * frequency_rad_per_s * time_s + slow_phase_rad);
      return amplitude * size * std::sin(frequency_rad_per_s * time_s + phase_rad);
    }
  };
  Pose T_walker_hand_;
  Pose T_hand_mount_;
  std::array<Swing, 5> swings_;  ///< roll, pitch, yaw, aside, up
};

/// A drive through the streets of a city.
Scenario make_street_scenario(const DriveSpec& spec, double duration_s) {
  const DriveStyle style = drive_style(spec.name);
  const auto city =
      std::make_shared<const City>(make_city(style.city, seed_of(spec.seed, DrivePart::kCity)));
  const auto path = std::make_shared<const DriverPath>(
      plan_path(city->layout, style.driver, spec.seed, duration_s));
  const auto traffic = std::make_shared<const Traffic>(
      city->layout, style, *path, seed_of(spec.seed, DrivePart::kTraffic), duration_s);
  const std::uint64_t sway_seed = seed_of(spec.seed, DrivePart::kSway);

  Scenario scenario{.scenery = city, .T_world_sensor = {}, .actors = {}};
  // The traffic refers to the city and the path.
  scenario.actors = [city, path, traffic](double from_s, double to_s,
                                          const Eigen::Vector2d& plane_m) {
    return traffic->actors(from_s, to_s, plane_m);
  };
  if (!style.hand) {
    const VehicleSway sway(sway_seed, spec.mount);
    scenario.T_world_sensor = [city, path, sway](double time_s) {
      const PathState state = path->at_time(time_s);
      return Pose(city->layout.terrain.frame(state.plane_m, state.heading_rad) *
                  sway.T_vehicle_sensor(state.along_m));
    };
  } else {
    const HandSway sway(sway_seed, *style.hand, spec.mount);
    scenario.T_world_sensor = [city, path, sway](double time_s) {
      // A walker is upright on any slope.
      const PathState state = path->at_time(time_s);
      const Eigen::Vector3d feet_m = city->layout.terrain.ground(state.plane_m, 0.0);
      return sway.T_world_sensor(upright_frame(feet_m, state.heading_rad), time_s);
    };
  }
  return scenario;
}

constexpr double kPace_mps = 1.0;
constexpr double kAcceleration_mps2 = 0.8;
constexpr double kStandStill_s = 0.5;
constexpr HandStyle kHand = {.swing_rad = 0.06};
constexpr double kSpare_m = 10.0;  ///< corners are cut, and the spline needs some points

/// Path of a walker on floors and stairs: a polyline with rounded corners, as control points of a
/// uniform cubic B-spline every quarter of a metre. The walker starts after half a second and then
/// keeps a constant pace. The path of a longer polyline begins with that of a shorter one.
class WalkingPath {
 public:
  explicit WalkingPath(const std::vector<Eigen::Vector3d>& waypoints_m)
      : control_m_(resampled(waypoints_m, kSpacing_m).points) {
    constexpr int kTurnSmoothingPasses = 8;
    smooth(control_m_, kTurnSmoothingPasses);
  }

  /// The walker's feet, upright, x forward.
  Pose T_world_walker(double time_s) const {
    const double since_s = std::max(0.0, time_s - kStandStill_s);
    const double ramp_s = kPace_mps / kAcceleration_mps2;
    const double along_m = since_s < ramp_s ? 0.5 * kAcceleration_mps2 * since_s * since_s
                                            : kPace_mps * (since_s - 0.5 * ramp_s);
    const auto value = spline_at(control_m_, along_m / kSpacing_m);
    return upright_frame(value.position, std::atan2(value.derivative.y(), value.derivative.x()));
  }

 private:
  static constexpr double kSpacing_m = 0.25;
  std::vector<Eigen::Vector3d> control_m_;
};

/// On foot through a building of two storeys.
Scenario make_indoor_scenario(const DriveSpec& spec, double duration_s) {
  const IndoorPlan plan = make_indoor_plan(seed_of(spec.seed, DrivePart::kCity));
  const WalkingPath path(
      indoor_route(plan, seed_of(spec.seed, DrivePart::kPath), kPace_mps * duration_s + kSpare_m));
  const HandSway sway(seed_of(spec.seed, DrivePart::kSway), kHand, spec.mount);
  const auto building = std::make_shared<Scenery>();
  building->fixed = make_indoor_mesh(plan);
  return {building,
          [path, sway](double time_s) {
            return sway.T_world_sensor(path.T_world_walker(time_s), time_s);
          },
          [](double /*from_s*/, double /*to_s*/, const Eigen::Vector2d& /*plane_m*/) {
            return std::vector<ActorMotion>{};
          }};
}

}  // namespace

Scenario make_scenario(const DriveSpec& spec, double duration_s) {
  return has_streets(spec.name) ? make_street_scenario(spec, duration_s)
                                : make_indoor_scenario(spec, duration_s);
}

}  // namespace hqslam::sim
