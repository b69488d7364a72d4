#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "bags/static_transforms.h"
#include "hqslam/core/imu_sample.h"

namespace hqslam::recordings {

/// The inertial data that belong to a stream of scans.
struct ImuStream {
  std::optional<std::size_t> stream;  ///< nothing where there are none
  /// Rotation of sensor_msgs/Imu into the frame of the scans.
  Eigen::Matrix3d R_sensor_imu = Eigen::Matrix3d::Identity();
  std::string note = {};  ///< a warning about the choice; "" or a line
};

/// In a capture it is the nearest port to which the sensor sends packets of inertial data. In a
/// bag, in this order: an Ouster's packets, if the scans are; a sensor_msgs/Imu in the frame of the
/// scans; one in a frame that /tf_static joins to it; the one whose topic shares most of its name
/// with that of the scans, level by level. Where two are equal in all of this and have other
/// frames: none.
ImuStream imu_stream(const std::vector<Stream>& streams, std::size_t scans,
                     const StaticTransforms& transforms);

/// The content of a sensor_msgs/Imu: rad/s, m/s^2. Throws Error for one that is damaged or marked
/// as lacking one of the two.
ImuSample imu_sample(const Message& message, const Eigen::Matrix3d& R_sensor_imu);

}  // namespace hqslam::recordings
