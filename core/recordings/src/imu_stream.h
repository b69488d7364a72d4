#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/imu_sample.h"
#include "static_transforms.h"

namespace hqslam::recordings {

/// Which inertial data belong to a stream of scans.
struct ImuStream {
  std::optional<std::size_t> stream;  ///< nothing where there are none
  /// Turns those of sensor_msgs/Imu into the frame of the scans.
  Eigen::Matrix3d R_sensor_imu = Eigen::Matrix3d::Identity();
  std::string note = {};  ///< what a user should know of the choice; "" or a line
};

/// Of a capture the nearest port to which the sensor sends packets of inertial data. Of a bag, in
/// this order: an Ouster's packets, if the scans are of such; a sensor_msgs/Imu in the frame of the
/// scans; in one that /tf_static joins to it; whose topic has more of its name in common with that
/// of the scans, name by name. Where two are as good in all of it and have other frames: none.
ImuStream imu_stream(const std::vector<Stream>& streams, std::size_t scans,
                     const StaticTransforms& transforms);

/// What a sensor_msgs/Imu says: rad/s, m/s^2. Throws Error for one that is damaged or says that it
/// has one of the two not.
ImuSample imu_sample(const Message& message, const Eigen::Matrix3d& R_sensor_imu);

}  // namespace hqslam::recordings
