#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>

#include "recording_file.h"

namespace hqslam::recordings {

/// How the frames of a bag are turned, by its topic /tf_static. Those of Ouster's drivers are known
/// without: os_lidar (once os1_lidar) looks backwards, os_imu forwards.
class StaticTransforms {
 public:
  StaticTransforms();
  /// Takes in a tf2_msgs/TFMessage; what is damaged or no rotation is passed over.
  void add(const Message& message);
  /// Turns vectors of one frame into another; nothing if no chain of transforms joins them.
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
