#include "points/recorded_scan.h"

#include <fmt/format.h>

#include <utility>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "points/ring_recovery.h"

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

std::string crowding_warning(const RecordedScan& scan) {
  const std::int64_t in_pixels = scan.counts.kept + scan.counts.hidden_by_nearer;
  if (4 * scan.counts.hidden_by_nearer <= in_pixels) return "";
  return fmt::format(
      "{}: {} of {} points kept, the nearest in each pixel of {} x {}; name a sensor with more "
      "columns to keep more",
      scan.name, scan.counts.kept, in_pixels, scan.cloud.rows, scan.cloud.columns);
}

}  // namespace hqslam::recordings
