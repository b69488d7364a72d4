#include "bags/imu_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "bags/message_packets.h"
#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

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
