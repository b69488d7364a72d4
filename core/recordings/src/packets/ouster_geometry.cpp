#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hqslam/core/angles.h"
#include "packets/ouster_decoder.h"

// A point of an Ouster frame.
//
// In:  range r of the beam in row i, measured when the head stood at column m; n, the distance of
//      the beams' beginning from the axis.
// Out: r d + n (h - d), d the unit vector along the beam, h the horizontal one along the head:
//      h = (cos a, sin a, 0), a = pi - m 2 pi / columns;
//      d = (cos e cos(a + o), cos e sin(a + o), sin e), e and o the beam's elevation and azimuth
//      offset. The sensor measures r from its axis along both pieces of the way, so r = n + the
//      beam's own length. The pixel is the one in which the sensor's model has the beam at m.
// Source: Ouster sensor documentation, "Lidar range to XYZ". Differs from it in the frame: turned
// to look forward, and not lowered to the sensor's base.

namespace hqslam::recordings {

namespace {

/// No turn takes longer: the times of such a frame are damaged.
constexpr double kMaxTurn_s = 1.0;

/// The middle between a turn's first and last column, by the sensor's clock; nothing if it has no
/// column or its times are not those of one turn.
std::optional<std::uint64_t> middle_ns(const OusterFrame& frame) {
  std::uint64_t first_ns = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last_ns = 0;
  for (std::size_t column = 0; column < frame.status.size(); ++column) {
    if (frame.status[column] == 0) continue;
    first_ns = std::min(first_ns, frame.timestamp_ns[column]);
    last_ns = std::max(last_ns, frame.timestamp_ns[column]);
  }
  if (first_ns > last_ns || 1e-9 * static_cast<double>(last_ns - first_ns) > kMaxTurn_s) {
    return std::nullopt;
  }
  return first_ns + (last_ns - first_ns) / 2;
}

}  // namespace

OusterGeometry::OusterGeometry(const OusterMetadata& metadata, const DecoderOptions& options)
    : metadata_(metadata), options_(options) {
  const SensorModel& sensor = metadata_.sensor;
  const double step_rad = sensor.column_step_rad();
  for (int row = 0; row < sensor.rows(); ++row) {
    const double elevation_rad = sensor.beam_elevation_rad[row];
    for (int column = 0; column < sensor.columns; ++column) {
      const double head_rad = std::numbers::pi - sensor.firing_column(row, column) * step_rad;
      const double azimuth_rad = sensor.azimuth_rad(row, column);
      const Eigen::Vector3d beam = direction_of(azimuth_rad, elevation_rad);
      const Eigen::Vector3d head(std::cos(head_rad), std::sin(head_rad), 0.0);
      beam_.push_back(beam.cast<float>());
      origin_.push_back((metadata_.beam_origin_m * (head - beam)).cast<float>());
    }
  }
}

bool OusterGeometry::keeps_second(const OusterFrame& frame, std::size_t at) const {
  if (frame.second_range_mm.empty()) return false;
  const std::uint32_t first_mm = frame.range_mm[at];
  if (options_.kept_return == KeptReturn::kLast) return frame.second_range_mm[at] > first_mm;
  return first_mm == 0;
}

void OusterGeometry::set_points(const OusterFrame& frame, OrganizedCloud& cloud) const {
  if (frame.range_mm.empty()) return;  // they were not read
  cloud.intensity.assign(cloud.range_m.size(), 0.0F);
  const SensorModel& sensor = metadata_.sensor;
  const auto columns = static_cast<std::size_t>(sensor.columns);
  const auto nearest_mm = static_cast<std::uint32_t>(std::ceil(1e3 * sensor.min_range_m));
  const auto farthest_mm = static_cast<std::uint32_t>(1e3 * std::min(sensor.max_range_m, 1e6));
  for (int row = 0; row < sensor.rows(); ++row) {
    const std::size_t first = columns * static_cast<std::size_t>(row);
    std::size_t measured = static_cast<std::size_t>(sensor.firing_column(row, 0));
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t at = first + measured;
      const bool second = keeps_second(frame, at);
      const std::uint32_t range_mm = second ? frame.second_range_mm[at] : frame.range_mm[at];
      if (++measured == columns) measured = 0;
      if (range_mm == 0 || range_mm < nearest_mm || range_mm > farthest_mm) continue;
      const std::size_t pixel = first + column;
      const Eigen::Vector3f point_m =
          1e-3F * static_cast<float>(range_mm) * beam_[pixel] + origin_[pixel];
      cloud.points_m[pixel] = point_m;
      cloud.range_m[pixel] = point_m.norm();
      cloud.intensity[pixel] = second ? frame.second_reflectivity[at] : frame.reflectivity[at];
    }
  }
}

std::optional<OusterScan> OusterGeometry::scan(const OusterFrame& frame) {
  const SensorModel& sensor = metadata_.sensor;
  const std::optional<std::uint64_t> middle = middle_ns(frame);
  if (!middle) return std::nullopt;
  // Unsigned, because a damaged file may hold any time.
  const auto first_packet_ns = static_cast<std::uint64_t>(clock_.recorded_ns(
      static_cast<std::int64_t>(frame.first_timestamp_ns), frame.first_capture_ns));
  const std::uint64_t stamp_ns = first_packet_ns + (*middle - frame.first_timestamp_ns);
  OusterScan scan;
  scan.stamp_s = 1e-9 * static_cast<double>(static_cast<std::int64_t>(stamp_ns));
  scan.sensor_stamp_s = 1e-9 * static_cast<double>(*middle);
  scan.cloud = OrganizedCloud(sensor.rows(), sensor.columns);
  // Columns that never came have the time that they would have had.
  std::vector<float> of_column_s(frame.status.size());
  for (std::size_t column = 0; column < of_column_s.size(); ++column) {
    of_column_s[column] =
        frame.status[column] != 0
            ? static_cast<float>(1e-9 * static_cast<double>(static_cast<std::int64_t>(
                                            frame.timestamp_ns[column] - *middle)))
            : static_cast<float>(((static_cast<double>(column) + 0.5) / sensor.columns - 0.5) *
                                 sensor.scan_period_s);
  }
  scan.cloud.time_offset_s.reserve(of_column_s.size() * static_cast<std::size_t>(sensor.rows()));
  for (int row = 0; row < sensor.rows(); ++row) {
    const auto begin = of_column_s.begin() + sensor.firing_column(row, 0);
    scan.cloud.time_offset_s.insert(scan.cloud.time_offset_s.end(), begin, of_column_s.end());
    scan.cloud.time_offset_s.insert(scan.cloud.time_offset_s.end(), of_column_s.begin(), begin);
  }
  set_points(frame, scan.cloud);
  return scan;
}

}  // namespace hqslam::recordings
