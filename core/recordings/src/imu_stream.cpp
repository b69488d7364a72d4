#include "imu_stream.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "hqslam/core/error.h"
#include "message_packets.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kMostFrames = 10'000;
/// A longer chain goes round.
constexpr int kMostLinks = 100;

/// How well inertial data suit scans: the larger, first number first. Nothing: not at all.
using Suits = std::array<int, 3>;

/// How many names two topics begin with that are the same: of /rear/points and /rear/imu 1.
int names_in_common(const std::string& a, const std::string& b) {
  const auto end = std::ranges::mismatch(a, b).in1;
  return static_cast<int>(std::count(a.begin(), end, '/'));
}

std::optional<Suits> suits(const Stream& stream, const Stream& scans,
                           const StaticTransforms& transforms) {
  const bool of_ouster = scans.kind == StreamKind::kOusterPackets;
  if (stream.kind != StreamKind::kInertialData) return std::nullopt;
  if (scans.endpoint.port != 0) {
    if (!of_ouster || stream.endpoint.address != scans.endpoint.address) return std::nullopt;
    return Suits{-std::abs(stream.endpoint.port - scans.endpoint.port)};
  }
  const int names = names_in_common(stream.name, scans.name);
  if (carries_packets(stream.type))
    return of_ouster ? std::optional(Suits{3, names}) : std::nullopt;
  const bool same = stream.frame == scans.frame;
  const bool joined = transforms.R(scans.frame, stream.frame).has_value();
  return Suits{same ? 2 : joined ? 1 : 0, names};
}

/// Other frames that nothing joins.
std::string note_of(const Stream& stream, const Stream& scans) {
  if (stream.frame.empty() || scans.frame.empty()) return "";
  return fmt::format(
      "{} is in frame '{}', the scans in '{}', and no /tf_static joins them: taken as if their "
      "axes were the same",
      stream.name, stream.frame, scans.frame);
}

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

ImuStream imu_stream(const std::vector<Stream>& streams, std::size_t scans,
                     const StaticTransforms& transforms) {
  const Stream& of = streams[scans];
  ImuStream result;
  std::optional<Suits> best;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const auto found = suits(streams[i], of, transforms);
    if (!found || (best && *found < *best)) continue;
    if (best == found && streams[i].frame != streams[*result.stream].frame) {
      result.note = fmt::format("{} and {} may be its inertial data: neither is used",
                                streams[*result.stream].name, streams[i].name);
    } else if (best != found) {
      result.note.clear();
      result.stream = i;
      best = found;
    }
  }
  if (!result.note.empty()) return {.stream = std::nullopt, .note = result.note};
  if (!result.stream || of.endpoint.port != 0) return result;
  const Stream& stream = streams[*result.stream];
  if (carries_packets(stream.type)) return result;
  if (const auto R_sensor_imu = transforms.R(of.frame, stream.frame)) {
    result.R_sensor_imu = *R_sensor_imu;
  } else {
    result.note = note_of(stream, of);
  }
  return result;
}

ImuSample imu_sample(const Message& message, const Eigen::Matrix3d& R_sensor_imu) {
  MessageReader reader(message);
  ImuSample sample;
  sample.stamp_s = 1e-9 * static_cast<double>(reader.header().time_ns);
  // The orientation and its covariance.
  for (int i = 0; i < 4 + 9; ++i) reader.f64();
  for (Eigen::Vector3d* vector : {&sample.angular_rate_rad_per_s, &sample.specific_force_mps2}) {
    const double x = reader.f64();
    const double y = reader.f64();
    const double z = reader.f64();
    *vector = R_sensor_imu * Eigen::Vector3d(x, y, z);
    if (reader.f64() == -1.0) throw Error("expected angular rates and accelerations, found one");
    for (int i = 1; i < 9; ++i) reader.f64();
  }
  return sample;
}

}  // namespace hqslam::recordings
