#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>

#include "recording_file.h"

namespace hqslam::recordings {

/// Rotations between the frames of a bag, from its topic /tf_static. The frames of Ouster's drivers
/// need none: os_lidar (formerly os1_lidar) faces backwards, os_imu forwards.
class StaticTransforms {
 public:
  StaticTransforms();
  /// Adds a tf2_msgs/TFMessage; damaged transforms are skipped.
  void add(const Message& message);
  /// Rotation of vectors from one frame into another; nothing if no transforms join the frames.
  std::optional<Eigen::Matrix3d> R(const std::string& to, const std::string& from) const;

 private:
  struct Link {
    std::string parent;
    Eigen::Matrix3d R_parent_child;
  };
  /// The frame itself, or the topmost one above it.
  Link above(const std::string& frame) const;

  std::map<std::string, Link> links_;  ///< by the child
};

}  // namespace hqslam::recordings
