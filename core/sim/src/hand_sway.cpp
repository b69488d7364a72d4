#include "hand_sway.h"

#include <cmath>
#include <numbers>

#include "random.h"

namespace hqslam::sim {

namespace {

struct Size {
  double amplitude;  ///< radians or metres
  double per_second;
};

}  // namespace

HandSway::HandSway(std::uint64_t seed, double largest_rad, const SensorMount& mount)
    : T_walker_hand_(pose_from_xyz_rpy({0.0, 0.0, mount.sensor_height_m}, 0.0, 0.0, 0.0)),
      T_hand_mount_(pose_from_xyz_rpy(Eigen::Vector3d::Zero(), mount.mount_roll_rad,
                                      mount.mount_pitch_rad, 0.0)) {
  const std::array<Size, 5> sizes = {{{largest_rad, 1.0},
                                      {largest_rad, 1.0},
                                      {0.3 * largest_rad, 0.5},
                                      {0.03, 1.0},
                                      {0.025, 2.0}}};
  Random random(seed);
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    Swing& swing = swings_[k];
    swing.amplitude = sizes[k].amplitude;
    swing.frequency_rad_per_s =
        2.0 * std::numbers::pi * sizes[k].per_second / random.uniform(0.95, 1.05);
    swing.phase_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
    swing.slow_phase_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
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
