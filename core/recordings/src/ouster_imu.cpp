#include "ouster_imu.h"

#include "hqslam/core/angles.h"

namespace hqslam::recordings {

namespace {

// The two are read 0.2 ms apart; turning needs its time more than pushing does.
constexpr std::size_t kGyroscopeTimeAt = 16;
constexpr std::size_t kAccelerationAt = 24;
constexpr std::size_t kAngularVelocityAt = 36;

Eigen::Vector3d vector_at(Bytes packet, std::size_t at) {
  return {little_endian<float>(packet, at), little_endian<float>(packet, at + 4),
          little_endian<float>(packet, at + 8)};
}

}  // namespace

ImuSample ouster_imu_sample(Bytes packet, const OusterMetadata& metadata) {
  ImuSample sample;
  sample.stamp_s =
      1e-9 * static_cast<double>(little_endian<std::uint64_t>(packet, kGyroscopeTimeAt));
  sample.angular_rate_rad_per_s =
      metadata.R_sensor_imu * (kDegree_rad * vector_at(packet, kAngularVelocityAt));
  sample.specific_force_mps2 =
      metadata.R_sensor_imu * (kGravity_mps2 * vector_at(packet, kAccelerationAt));
  return sample;
}

}  // namespace hqslam::recordings
