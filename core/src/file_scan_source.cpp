#include "file_scan_source.h"

#include <fmt/format.h>

#include <numbers>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/core/kitti_bin.h"
#include "hqslam/core/pcd.h"
#include "hqslam/core/ring_recovery.h"

namespace hqslam {

namespace {

/// A scan with fewer points may look any way; one with more tells which sensor it is from.
constexpr std::size_t kMinPointsToJudge = 1000;
constexpr double kMaxForeignShare = 0.5;

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

void require_rings_of(const SensorModel& sensor, const RingRecovery& rings, std::size_t points,
                      const std::string& path) {
  if (points < kMinPointsToJudge) return;
  const int max_spurious_wraps = 2 + sensor.rows() / 16;
  if (rings.spurious_wraps > max_spurious_wraps) {
    throw Error(
        fmt::format("{}: expected a scan of sensor '{}' with {} rings, found {} rings; "
                    "name the sensor that recorded the scan",
                    path, sensor.name, sensor.rows(),
                    sensor.rows() - rings.empty_rings + rings.spurious_wraps));
  }
  if (rings.off_table_share > kMaxForeignShare) {
    throw Error(
        fmt::format("{}: expected a scan of sensor '{}', found {:.0f} % of the points on "
                    "rings whose elevations are not those of its beams; name the sensor "
                    "that recorded the scan",
                    path, sensor.name, 100.0 * rings.off_table_share));
  }
}

void require_directions_of(const SensorModel& sensor, const ProjectionCounts& counts,
                           std::size_t points, const std::string& path) {
  if (points < kMinPointsToJudge) return;
  const auto share = [&](std::int64_t count) {
    return static_cast<double>(count) / static_cast<double>(points);
  };
  if (share(counts.outside_rows) > kMaxForeignShare) {
    throw Error(fmt::format(
        "{}: expected points between {:.1f} and {:.1f} degrees of elevation "
        "(sensor '{}'), found {:.0f} % outside; name the sensor that recorded "
        "the scan",
        path, degrees(sensor.beam_elevation_rad.back()), degrees(sensor.beam_elevation_rad.front()),
        sensor.name, 100.0 * share(counts.outside_rows)));
  }
  if (share(counts.out_of_range) > kMaxForeignShare) {
    throw Error(
        fmt::format("{}: expected ranges from {} to {} m (sensor '{}'), found {:.0f} % of "
                    "the points outside; give coordinates in metres",
                    path, sensor.min_range_m, sensor.max_range_m, sensor.name,
                    100.0 * share(counts.out_of_range)));
  }
}

/// Rows by rings where the file has its points in rings, by elevation otherwise.
Scan kitti_scan_with_rows(const std::string& path, const SensorModel& sensor) {
  Scan scan = read_kitti_bin(path);
  if (!stored_ring_after_ring(scan, sensor)) return scan;
  RingRecovery rings;
  try {
    rings = recover_rings(scan, sensor);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path, error.what()));
  }
  require_rings_of(sensor, rings, scan.points_m.size(), path);
  scan.row = std::move(rings.row);
  return scan;
}

class FileScanSource : public ScanSource {
 public:
  FileScanSource(std::vector<std::string> paths, SensorModel sensor)
      : paths_(std::move(paths)), sensor_(std::move(sensor)) {}

  const SensorModel& sensor() const override { return sensor_; }
  std::int64_t size() const override { return static_cast<std::int64_t>(paths_.size()); }

  std::optional<RecordedScan> next() override {
    if (next_ == paths_.size()) return std::nullopt;
    const std::string& path = paths_[next_];
    const Scan scan =
        path.ends_with(".pcd") ? read_pcd(path, sensor_) : kitti_scan_with_rows(path, sensor_);
    ProjectedScan projected = project(scan, sensor_);
    require_directions_of(sensor_, projected.counts, scan.points_m.size(), path);
    RecordedScan result;
    result.name = path;
    result.stamp_s = static_cast<double>(next_) * sensor_.scan_period_s;
    result.cloud = std::move(projected.cloud);
    result.counts = projected.counts;
    result.invalid_points = scan.invalid_points;
    ++next_;
    return result;
  }

 private:
  std::vector<std::string> paths_;
  SensorModel sensor_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<ScanSource> make_file_scan_source(std::vector<std::string> paths,
                                                  const SensorModel& sensor) {
  return std::make_unique<FileScanSource>(std::move(paths), sensor);
}

}  // namespace hqslam
