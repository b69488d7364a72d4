#include "carried_motion.h"

#include "mesh.h"

namespace hqslam::sim {

namespace {

constexpr double kTenDegrees_rad = 0.17453292519943295;

}  // namespace

CarriedMotion::CarriedMotion(const DriverPath& path, const Terrain& terrain,
                             const SensorMount& mount, std::uint64_t seed)
    : path_(path),
      terrain_(terrain),
      T_walker_hand_(pose_from_xyz_rpy({0.0, 0.0, mount.sensor_height_m}, 0.0, 0.0, 0.0)),
      T_hand_mount_(pose_from_xyz_rpy(Eigen::Vector3d::Zero(), mount.mount_roll_rad,
                                      mount.mount_pitch_rad, 0.0)),
      sway_(seed, kTenDegrees_rad) {}

Pose CarriedMotion::T_world_sensor(double time_s) const {
  const PathState state = path_.at_time(time_s);
  const Pose T_world_walker = upright_frame(
      {state.plane_m.x(), state.plane_m.y(), terrain_.height_m(state.plane_m)}, state.heading_rad);
  return T_world_walker * T_walker_hand_ * sway_.T_hand_sensor(time_s) * T_hand_mount_;
}

}  // namespace hqslam::sim
