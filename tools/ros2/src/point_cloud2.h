#pragma once

#include <Eigen/Core>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <std_msgs/msg/header.hpp>
#include <vector>

#include "hqslam/core/scan.h"

namespace hqslam_ros {

using PointCloud2 = sensor_msgs::msg::PointCloud2;

/// Points of a turn with their times, in seconds if they are floating-point numbers and else in
/// nanoseconds. Some drivers count them from the message's stamp, others write those of a clock,
/// which only a double can tell apart. Rows come from the elevation: drivers do not agree on
/// whether ring 0 is the highest beam or the lowest. Throws hqslam::Error.
hqslam::Scan scan_of(const PointCloud2& message);

/// x y z, as float32.
PointCloud2 message_of(const std::vector<Eigen::Vector3f>& points_m,
                       const std_msgs::msg::Header& header);

}  // namespace hqslam_ros
