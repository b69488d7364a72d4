#include "bags/static_transforms.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "bags/message_packets.h"
#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kMostFrames = 10'000;
/// A longer chain goes round.
constexpr int kMostLinks = 100;

}  // namespace

StaticTransforms::StaticTransforms() {
  for (const std::string sensor : {"os", "os1"}) {
    links_[sensor + "_lidar"] = {sensor + "_sensor", Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal()};
    links_[sensor + "_imu"] = {sensor + "_sensor", Eigen::Matrix3d::Identity()};
  }
}

void StaticTransforms::add(const Message& message) {
  try {
    MessageReader reader(message);
    for (std::uint32_t left = reader.u32(); left > 0; --left) {
      const std::string parent = reader.header().frame;
      std::string child = reader.words();
      if (child.starts_with('/')) child.erase(0, 1);
      std::array<double, 7> values{};  // the translation, then the quaternion x y z w
      for (double& value : values) value = reader.f64();
      const Eigen::Quaterniond q(values[6], values[3], values[4], values[5]);
      if (!(std::abs(q.norm() - 1.0) < 1e-2) || links_.size() == kMostFrames) continue;
      // Frames of streams are known by as many characters.
      if (parent.size() > kNameCharacters || child.size() > kNameCharacters) continue;
      links_[child] = {parent, q.normalized().toRotationMatrix()};
    }
  } catch (const Error&) {
    return;  // those before the damage are there
  }
}

StaticTransforms::Link StaticTransforms::above(const std::string& frame) const {
  Link result{frame, Eigen::Matrix3d::Identity()};
  for (int i = 0; i < kMostLinks; ++i) {
    const auto link = links_.find(result.parent);
    if (link == links_.end()) break;
    result = {link->second.parent, link->second.R_parent_child * result.R_parent_child};
  }
  return result;
}

std::optional<Eigen::Matrix3d> StaticTransforms::R(const std::string& to,
                                                   const std::string& from) const {
  const Link top_of_to = above(to);
  const Link top_of_from = above(from);
  if (top_of_to.parent != top_of_from.parent) return std::nullopt;
  return top_of_to.R_parent_child.transpose() * top_of_from.R_parent_child;
}

}  // namespace hqslam::recordings
