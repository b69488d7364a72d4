#pragma once

#include <cstdint>

#include "driver_path.h"
#include "hand_sway.h"
#include "hqslam/sim/drive.h"
#include "sensor_motion.h"
#include "terrain.h"

namespace hqslam::sim {

/// The sensor in the hand of somebody who walks along the path: upright whatever the slope, and
/// never quite still.
class CarriedMotion final : public SensorMotion {
 public:
  CarriedMotion(const DriverPath& path, const Terrain& terrain, const SensorMount& mount,
                std::uint64_t seed);
  Pose T_world_sensor(double time_s) const override;

 private:
  const DriverPath& path_;
  const Terrain& terrain_;
  HandSway sway_;
};

}  // namespace hqslam::sim
