#include "vehicle_motion.h"

#include <cmath>
#include <numbers>

#include "on_ground.h"
#include "random.h"

namespace hqslam::sim {

VehicleMotion::VehicleMotion(const DriverPath& path, const Terrain& terrain,
                             const SensorMount& mount, std::uint64_t seed)
    : path_(path), terrain_(terrain), mount_(mount) {
  Random random(seed);
  constexpr double kRoll_rad = 0.0035;
  constexpr double kPitch_rad = 0.0025;
  constexpr double kHeave_m = 0.008;
  for (const double wavelength_m : {47.0, 23.0, 13.0, 8.0}) {
    const double size = std::sqrt(wavelength_m / 47.0);
    const auto draw = [&](double amplitude) {
      return Sway{2.0 * std::numbers::pi / (wavelength_m * random.uniform(0.85, 1.15)),
                  random.uniform(0.0, 2.0 * std::numbers::pi), amplitude * size};
    };
    roll_.push_back(draw(kRoll_rad));
    pitch_.push_back(draw(kPitch_rad));
    heave_.push_back(draw(kHeave_m));
  }
}

double VehicleMotion::sum(const std::vector<Sway>& sways, double along_m) {
  double total = 0.0;
  for (const Sway& sway : sways) {
    total += sway.amplitude * std::sin(sway.wave_number_rad_per_m * along_m + sway.phase_rad);
  }
  return total;
}

Pose VehicleMotion::T_world_sensor(double time_s) const {
  const PathState state = path_.at_time(time_s);
  const Pose T_world_car = on_ground(terrain_, state.plane_m, state.heading_rad);
  const Pose T_car_sensor =
      pose_from_xyz_rpy({0.0, 0.0, mount_.sensor_height_m + sum(heave_, state.along_m)},
                        mount_.mount_roll_rad + sum(roll_, state.along_m),
                        mount_.mount_pitch_rad + sum(pitch_, state.along_m), 0.0);
  return T_world_car * T_car_sensor;
}

}  // namespace hqslam::sim
