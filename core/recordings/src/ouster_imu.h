#pragma once

#include "byte_reader.h"
#include "hqslam/core/imu_sample.h"
#include "hqslam/recordings/ouster.h"

namespace hqslam::recordings {

/// Of a packet of inertial data in the profile LEGACY. No lidar packet is as small.
inline constexpr std::size_t kOusterImuBytes = 48;

/// What such a packet says, turned into the frame of the scans; its stamp is by the clock of the
/// columns. The sensor's place, three centimetres from where the beams begin, is left out.
/// Source: Ouster sensor documentation, "IMU data format": times of the system, of reading the
/// accelerometer and of reading the gyroscope, ns; acceleration x y z, g; angular velocity x y z,
/// degrees a second.
ImuSample ouster_imu_sample(Bytes packet, const OusterMetadata& metadata);

}  // namespace hqslam::recordings
