#include "sway.h"

#include <cmath>
#include <numbers>

#include "random.h"

namespace hqslam::sim {

namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

}  // namespace

VehicleSway::VehicleSway(std::uint64_t seed, const SensorMount& mount) : mount_(mount) {
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

Pose VehicleSway::T_vehicle_sensor(double along_m) const {
  std::array<double, 3> sums{};
  for (std::size_t part = 0; part < sums.size(); ++part) {
    for (const Wave& wave : waves_[part]) {
      sums[part] +=
          wave.amplitude * std::sin(wave.wave_number_rad_per_m * along_m + wave.phase_rad);
    }
  }
  return pose_from_xyz_rpy({0.0, 0.0, mount_.sensor_height_m + sums[2]},
                           mount_.mount_roll_rad + sums[0], mount_.mount_pitch_rad + sums[1], 0.0);
}

HandSway::HandSway(std::uint64_t seed, const HandStyle& style, const SensorMount& mount)
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

double HandSway::Swing::at(double time_s) const {
  const double size = 0.85 + 0.15 * std::sin(0.11 * frequency_rad_per_s * time_s + slow_phase_rad);
  return amplitude * size * std::sin(frequency_rad_per_s * time_s + phase_rad);
}

Pose HandSway::T_world_sensor(const Pose& T_world_walker, double time_s) const {
  const Pose T_hand_swung =
      pose_from_xyz_rpy({0.0, swings_[3].at(time_s), swings_[4].at(time_s)}, swings_[0].at(time_s),
                        swings_[1].at(time_s), swings_[2].at(time_s));
  return T_world_walker * T_walker_hand_ * T_hand_swung * T_hand_mount_;
}

}  // namespace hqslam::sim
