#include "carried_motion.h"

#include "mesh.h"

namespace hqslam::sim {

namespace {

constexpr double kTenDegrees_rad = 0.17453292519943295;

}  // namespace

CarriedMotion::CarriedMotion(const DriverPath& path, const Terrain& terrain,
                             const SensorMount& mount, std::uint64_t seed)
    : path_(path), terrain_(terrain), sway_(seed, kTenDegrees_rad, mount) {}

Pose CarriedMotion::T_world_sensor(double time_s) const {
  const PathState state = path_.at_time(time_s);
  const Pose T_world_walker = upright_frame(
      {state.plane_m.x(), state.plane_m.y(), terrain_.height_m(state.plane_m)}, state.heading_rad);
  return sway_.T_world_sensor(T_world_walker, time_s);
}

}  // namespace hqslam::sim
