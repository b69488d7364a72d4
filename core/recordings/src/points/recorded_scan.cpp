#include "points/recorded_scan.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "points/ring_recovery.h"
#include "points/ring_segments.h"

namespace hqslam::recordings {

namespace {

/// The sensor of a scan with fewer points is not checked.
constexpr std::size_t kMinPointsToJudge = 1000;

void require_rings_of(const SensorModel& sensor, const RingRecovery& rings,
                      const std::string& source) {
  if (rings.row.size() < kMinPointsToJudge) return;
  const int max_spurious_wraps = 2 + sensor.rows() / 16;
  if (rings.spurious_wraps > max_spurious_wraps) {
    throw Error(
        "{}: expected a scan of sensor '{}' with {} rings, found {} rings; name the sensor that "
        "recorded the scan",
        source, sensor.name, sensor.rows(),
        sensor.rows() - rings.empty_rings + rings.spurious_wraps);
  }
  if (rings.off_table_share > kMaxForeignShare) {
    throw Error(
        "{}: expected a scan of sensor '{}', found {:.0f} % of the points on rings whose "
        "elevations are not those of its beams; name the sensor that recorded the scan",
        source, sensor.name, 100.0 * rings.off_table_share);
  }
}

void require_directions_of(const SensorModel& sensor, const ProjectionCounts& counts,
                           std::size_t points, const std::string& source) {
  if (points < kMinPointsToJudge) return;
  const auto share = [&](std::int64_t count) {
    return static_cast<double>(count) / static_cast<double>(points);
  };
  if (share(counts.outside_rows) > kMaxForeignShare) {
    throw Error(
        "{}: expected points between {:.1f} and {:.1f} degrees of elevation (sensor '{}'), found "
        "{:.0f} % outside; name the sensor that recorded the scan",
        source, degrees(sensor.beam_elevation_rad.back()),
        degrees(sensor.beam_elevation_rad.front()), sensor.name,
        100.0 * share(counts.outside_rows));
  }
  if (share(counts.out_of_range) > kMaxForeignShare) {
    throw Error(
        "{}: expected ranges from {} to {} m (sensor '{}'), found {:.0f} % of the points outside; "
        "give coordinates in metres",
        source, sensor.min_range_m, sensor.max_range_m, sensor.name,
        100.0 * share(counts.out_of_range));
  }
}

/// How many points are nearer to another beam than to that of their row.
std::int64_t points_off_beams(const OrganizedCloud& cloud, const SensorModel& sensor) {
  const std::vector<double> spacing_rad = beam_spacing_rad(sensor);
  std::int64_t off = 0;
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < cloud.columns; ++column) {
      const Eigen::Vector3f& point_m = cloud.points_m[cloud.index(row, column)];
      if (!(cloud.range_m[cloud.index(row, column)] > 0.0F)) continue;
      const double elevation_rad = std::atan2(point_m.z(), point_m.head<2>().norm());
      const double off_rad = std::abs(elevation_rad - sensor.beam_elevation_rad[row]);
      if (off_rad > spacing_rad[row] / 2.0) ++off;
    }
  }
  return off;
}

}  // namespace

void set_rows_by_order(Scan& scan, const SensorModel& sensor, const std::string& source) {
  if (!scan.row.empty() || scan.points_m.empty() || !stored_ring_after_ring(scan, sensor)) return;
  RingRecovery rings;
  try {
    rings = recover_rings(scan, sensor);
  } catch (const Error& error) {
    throw Error("{}: {}", source, error.what());
  }
  require_rings_of(sensor, rings, source);
  scan.row = std::move(rings.row);
}

RecordedScan recorded_scan(const Scan& scan, const SensorModel& sensor, std::string name) {
  ProjectedScan projected = project(scan, sensor);
  require_directions_of(sensor, projected.counts, scan.points_m.size(), name);
  RecordedScan result;
  result.name = std::move(name);
  result.stamp_s = scan.stamp_s;
  result.cloud = std::move(projected.cloud);
  result.counts = projected.counts;
  result.invalid_points = scan.invalid_points;
  return result;
}

std::string fit_warning(const RecordedScan& scan, const SensorModel& sensor) {
  const std::int64_t off_beams = points_off_beams(scan.cloud, sensor);
  if (2 * off_beams > scan.counts.kept) {
    return fmt::format(
        "{}: {:.0f} % of the points are nearer to another beam of sensor '{}' than to that of "
        "their ring: SLAM takes them as they are, but upsampling needs clouds in the sensor's own "
        "frame, neither tilted, moved nor merged",
        scan.name, 100.0 * static_cast<double>(off_beams) / static_cast<double>(scan.counts.kept),
        sensor.name);
  }
  const std::int64_t in_pixels = scan.counts.kept + scan.counts.hidden_by_nearer;
  if (4 * scan.counts.hidden_by_nearer <= in_pixels) return "";
  return fmt::format(
      "{}: {} of {} points kept, the nearest in each pixel of {} x {}; name a sensor with more "
      "columns to keep more",
      scan.name, scan.counts.kept, in_pixels, scan.cloud.rows, scan.cloud.columns);
}

}  // namespace hqslam::recordings
