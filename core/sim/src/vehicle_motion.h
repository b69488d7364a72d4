#pragma once

#include <cstdint>

#include "driver_path.h"
#include "hqslam/sim/drive.h"
#include "sensor_motion.h"
#include "terrain.h"

namespace hqslam::sim {

/// The sensor on the roof of the car: follows the slope of the street and sways a little on its
/// springs. The swaying depends on the distance driven, so that a standing car stands still and
/// the pose is as smooth in time as the path.
class VehicleMotion final : public SensorMotion {
 public:
  VehicleMotion(const DriverPath& path, const Terrain& terrain, const SensorMount& mount,
                std::uint64_t seed);
  Pose T_world_sensor(double time_s) const override;

 private:
  struct Sway {
    double wave_number_rad_per_m;
    double phase_rad;
    double amplitude;
  };
  static double sum(const std::vector<Sway>& sways, double along_m);

  const DriverPath& path_;
  const Terrain& terrain_;
  SensorMount mount_;
  std::vector<Sway> roll_;
  std::vector<Sway> pitch_;
  std::vector<Sway> heave_;
};

}  // namespace hqslam::sim
