#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/header.hpp>
#include <string>

#include "frames.h"

namespace hqslam_ros {

// Poses, covariances and times to messages and back.

using geometry_msgs::msg::TransformStamped;
using std_msgs::msg::Header;

template <typename Position>
Eigen::Vector3d vector_of(const Position& xyz) {
  return {xyz.x, xyz.y, xyz.z};
}

template <typename Position>
void set(Position& xyz, const Eigen::Vector3d& vector) {
  xyz.x = vector.x();
  xyz.y = vector.y();
  xyz.z = vector.z();
}

template <typename Position, typename Orientation>
void set(Position& position, Orientation& orientation, const hqslam::Pose& pose) {
  set(position, pose.translation());
  const Eigen::Quaterniond turn(pose.rotation());
  set(orientation, turn.vec());
  orientation.w = turn.w();
}

inline void set(std::array<double, 36>& rows, const Matrix6& covariance) {
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(rows.data()) = covariance;
}

inline hqslam::Pose pose_of(const TransformStamped& message) {
  const auto& turn = message.transform.rotation;
  hqslam::Pose pose(Eigen::Quaterniond(turn.w, turn.x, turn.y, turn.z).normalized());
  pose.translation() = vector_of(message.transform.translation);
  return pose;
}

inline TransformStamped message_of(const hqslam::Pose& T_parent_child, const Header& header,
                                   const std::string& child) {
  TransformStamped message;
  message.header = header;
  message.child_frame_id = child;
  set(message.transform.translation, message.transform.rotation, T_parent_child);
  return message;
}

inline rclcpp::Time time_of(double stamp_s) {
  return rclcpp::Time(static_cast<std::int64_t>(1e9 * stamp_s));
}

inline Header header_of(const std::string& frame, double stamp_s) {
  Header header;
  header.frame_id = frame;
  header.stamp = time_of(stamp_s);
  return header;
}

}  // namespace hqslam_ros
