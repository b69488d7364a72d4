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

/// T_world_sensor of a sensor that its carrier sways; x of the carrier is forward.
using Sway = std::function<Pose(const Pose& T_world_carrier, double along)>;

/// Sway of a car with the sensor on its roof as a function of the distance s driven, so that a
/// standing car does not move and the pose is as smooth in time as the path:
///   roll, pitch, heave = sum_k a_k sin(w_k s + p_k),  2 pi / w_k about 47, 23, 13 and 8 m
Sway vehicle_sway(std::uint64_t seed, const SensorMount& mount) {
  constexpr std::array<double, 4> kWavelength_m = {47.0, 23.0, 13.0, 8.0};
  constexpr std::array<double, 3> kAmplitude = {0.0035, 0.0025, 0.008};  // radians, metres
  struct Wave {
    std::size_t part;  ///< roll, pitch, heave
    double amplitude;
    double wave_number_rad_per_m;
    double phase_rad;
  };
  std::vector<Wave> waves;
  Random random(seed);
  for (const double wavelength_m : kWavelength_m) {
    const double size = std::sqrt(wavelength_m / kWavelength_m[0]);
    for (std::size_t part = 0; part < kAmplitude.size(); ++part) {
      const double wave_number = kTurn_rad / (wavelength_m * random.uniform(0.85, 1.15));
      waves.push_back({part, kAmplitude[part] * size, wave_number, random.uniform(0.0, kTurn_rad)});
    }
  }
  return [waves, mount](const Pose& T_world_vehicle, double along_m) {
    std::array<double, 3> sums{};
    for (const Wave& w : waves) {
      sums[w.part] += w.amplitude * std::sin(w.wave_number_rad_per_m * along_m + w.phase_rad);
    }
    return T_world_vehicle * pose_from_xyz_rpy({0.0, 0.0, mount.sensor_height_m + sums[2]},
                                               mount.mount_roll_rad + sums[0],
                                               mount.mount_pitch_rad + sums[1], 0.0);
  };
}

/// Sway of a sensor in the hand of a walker over time: roll, pitch and yaw of the style's sizes,
/// and a rise with every step.
///   angle(t) = A (0.85 + 0.15 sin(w_slow t + p_slow)) sin(w t + p),  2 pi / w = 0.95 to 1.05 s
Sway hand_sway(std::uint64_t seed, const HandStyle& style, const SensorMount& mount) {
  constexpr std::size_t kSwings = 5;  // roll, pitch, yaw, aside, up
  const std::array<double, kSwings> amplitude = {style.swing_rad, style.swing_rad, style.turn_rad,
                                                 0.03, 0.025};
  constexpr std::array<double, kSwings> kPerSecond = {1.0, 1.0, 0.5, 1.0, 2.0};
  struct Swing {
    double frequency_rad_per_s;
    double phase_rad;
    double slow_phase_rad;
  };
  std::array<Swing, kSwings> swings;
  Random random(seed);
  for (std::size_t k = 0; k < kSwings; ++k) {
    swings[k] = {kTurn_rad * kPerSecond[k] / random.uniform(0.95, 1.05),
                 random.uniform(0.0, kTurn_rad), random.uniform(0.0, kTurn_rad)};
  }
  return [amplitude, swings, mount](const Pose& T_world_walker, double time_s) {
    std::array<double, kSwings> at;
    for (std::size_t k = 0; k < kSwings; ++k) {
      const auto& [frequency, phase_rad, slow_phase_rad] = swings[k];
      const double size = 0.85 + 0.15 * std::sin(0.11 * frequency * time_s + slow_phase_rad);
      at[k] = amplitude[k] * size * std::sin(frequency * time_s + phase_rad);
    }
    return T_world_walker * pose_from_xyz_rpy({0.0, 0.0, mount.sensor_height_m}, 0.0, 0.0, 0.0) *
           pose_from_xyz_rpy({0.0, at[3], at[4]}, at[0], at[1], at[2]) *
           pose_from_xyz_rpy({0.0, 0.0, 0.0}, mount.mount_roll_rad, mount.mount_pitch_rad, 0.0);
  };
}

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
  const bool on_foot = style.hand.has_value();
  const Sway sway =
      on_foot ? hand_sway(sway_seed, *style.hand, spec.mount) : vehicle_sway(sway_seed, spec.mount);
  return {city,
          [city, path, on_foot, sway](double time_s) {
            const PathState state = path->at_time(time_s);
            const Terrain& terrain = city->layout.terrain;
            if (!on_foot)
              return sway(terrain.frame(state.plane_m, state.heading_rad), state.along_m);
            // A walker is upright on any slope.
            const Eigen::Vector3d feet_m = terrain.ground(state.plane_m, 0.0);
            return sway(upright_frame(feet_m, state.heading_rad), time_s);
          },
          // The traffic refers to the city and the path.
          [city, path, traffic](double from_s, double to_s, const Eigen::Vector2d& plane_m) {
            return traffic->actors(from_s, to_s, plane_m);
          }};
}

constexpr double kPace_mps = 1.0;
constexpr double kSpare_m = 10.0;  ///< corners are cut, and the spline needs some points
constexpr double kSpacing_m = 0.25;

/// A walker's feet, upright, x forward, on floors and stairs. `control_m` are the control points of
/// a uniform cubic B-spline every quarter of a metre. The walker starts after half a second and
/// then keeps a constant pace.
Pose T_world_walker(const std::vector<Eigen::Vector3d>& control_m, double time_s) {
  constexpr double kStandStill_s = 0.5;
  constexpr double kAcceleration_mps2 = 0.8;
  const double since_s = std::max(0.0, time_s - kStandStill_s);
  const double ramp_s = kPace_mps / kAcceleration_mps2;
  const double along_m = since_s < ramp_s ? 0.5 * kAcceleration_mps2 * since_s * since_s
                                          : kPace_mps * (since_s - 0.5 * ramp_s);
  const auto value = spline_at(control_m, along_m / kSpacing_m);
  return upright_frame(value.position, std::atan2(value.derivative.y(), value.derivative.x()));
}

/// On foot through a building of two storeys, along a polyline with rounded corners. The path of a
/// longer drive begins with that of a shorter one.
Scenario make_indoor_scenario(const DriveSpec& spec, double duration_s) {
  constexpr int kTurnSmoothingPasses = 8;
  constexpr HandStyle kHand = {.swing_rad = 0.06};
  const IndoorPlan plan = make_indoor_plan(seed_of(spec.seed, DrivePart::kCity));
  const double length_m = kPace_mps * duration_s + kSpare_m;
  auto control_m =
      resampled(indoor_route(plan, seed_of(spec.seed, DrivePart::kPath), length_m), kSpacing_m)
          .points;
  smooth(control_m, kTurnSmoothingPasses);
  const Sway sway = hand_sway(seed_of(spec.seed, DrivePart::kSway), kHand, spec.mount);
  const auto building = std::make_shared<Scenery>();
  building->fixed = make_indoor_mesh(plan);
  return {
      building,
      [control_m, sway](double time_s) { return sway(T_world_walker(control_m, time_s), time_s); },
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
