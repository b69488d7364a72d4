#include "file_scan_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <utility>

#include "azimuth_times.h"
#include "hqslam/core/error.h"
#include "hqslam/core/kitti_bin.h"
#include "hqslam/core/pcd.h"
#include "hqslam/core/ring_recovery.h"
#include "own_elevations.h"
#include "scan_stamps.h"
#include "text_points.h"

namespace hqslam {

namespace {

namespace fs = std::filesystem;

/// A scan with fewer points may look any way; one with more tells which sensor it is from.
constexpr std::size_t kMinPointsToJudge = 1000;
constexpr double kMaxForeignShare = 0.5;
constexpr std::size_t kScansToTry = 10;
constexpr std::size_t kScansToLearnFrom = 5;

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

/// The points of a file of any kind; rows where it says them.
Scan read_points(const std::string& path, const SensorModel& sensor) {
  if (path.ends_with(".pcd")) return read_pcd(path, sensor);
  if (path.ends_with(".ply")) return scan_of(read_ply_points(path), &sensor, path);
  if (path.ends_with(".bin")) return read_kitti_bin(path);
  return scan_of(read_text_points(path), &sensor, path);
}

/// Rows by rings where the file says them or has its points in rings, by elevation otherwise.
Scan scan_with_rows(const std::string& path, const SensorModel& sensor, bool check) {
  Scan scan = read_points(path, sensor);
  if (!scan.row.empty() || path.ends_with(".pcd") || !stored_ring_after_ring(scan, sensor)) {
    return scan;
  }
  RingRecovery rings;
  try {
    rings = recover_rings(scan, sensor);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path, error.what()));
  }
  if (check) require_rings_of(sensor, rings, scan.points_m.size(), path);
  scan.row = std::move(rings.row);
  return scan;
}

class FileScanSource : public ScanSource {
 public:
  FileScanSource(std::vector<std::string> paths, SensorModel sensor,
                 const RecordingOptions& options)
      : paths_(std::move(paths)),
        sensor_(std::move(sensor)),
        times_from_azimuth_(options.times_from_azimuth),
        azimuth_times_(sensor_.scan_period_s) {
    read_stamps(options.stamps);
    use_own_elevations();
  }

  std::vector<std::string> warnings() const override { return warnings_; }

  const SensorModel& sensor() const override { return sensor_; }
  std::int64_t size() const override { return static_cast<std::int64_t>(paths_.size()); }

  std::optional<RecordedScan> next() override {
    if (next_ == paths_.size()) return std::nullopt;
    const std::size_t index = next_++;
    try {
      RecordedScan result = recorded(paths_[index], index);
      any_used_ = true;
      return result;
    } catch (const Error& error) {
      // One scan may be damaged; if the first ones all are, the recording is not what it should be.
      if (!any_used_ && index + 1 >= std::min(kScansToTry, paths_.size())) throw;
      throw ScanError(error.what());
    }
  }

 private:
  /// The stamps that are asked for, or those of KITTI's timestamps.txt.
  void read_stamps(const std::string& wanted) {
    std::string path = wanted;
    if (wanted == kStampsFromNames) {
      stamps_s_ = stamps_from_names_s(paths_);
      return;
    }
    const fs::path folder = fs::path(paths_.front()).parent_path();
    for (const fs::path& above : {folder, folder.parent_path()}) {
      std::error_code error;
      const fs::path usual = above / "timestamps.txt";
      if (path.empty() && paths_.size() > 1 && fs::is_regular_file(usual, error)) {
        path = usual.string();
      }
    }
    if (path.empty()) return;
    stamps_s_ = read_stamps_s(path);
    if (stamps_s_.size() != paths_.size()) {
      throw Error(
          fmt::format("{}: expected a stamp for each of {} scans, found {}; give a file with "
                      "as many lines",
                      path, paths_.size(), stamps_s_.size()));
    }
  }

  void use_own_elevations() {
    std::vector<Scan> scans;
    for (std::size_t i = 0; i < std::min(kScansToLearnFrom, paths_.size()); ++i) {
      try {
        scans.push_back(scan_with_rows(paths_[i], sensor_, false));
      } catch (const Error&) {
        continue;  // will be said when it is its turn
      }
    }
    if (auto own = with_own_elevations(sensor_, scans)) {
      warnings_.push_back(fmt::format(
          "{}: the beams are off the table of sensor '{}'; read with those of this unit, from its "
          "first scans",
          paths_.front(), sensor_.name));
      sensor_ = std::move(*own);
    }
  }

  double stamp_s(const Scan& scan, std::size_t index) const {
    if (!stamps_s_.empty()) return stamps_s_[index];
    if (scan.stamp_s != 0.0) return scan.stamp_s;
    return static_cast<double>(index) * sensor_.scan_period_s;
  }

  RecordedScan recorded(const std::string& path, std::size_t index) {
    Scan scan = scan_with_rows(path, sensor_, true);
    if (times_from_azimuth_ && scan.time_offset_s.empty()) {
      azimuth_times_.set(scan, sensor_, index);
    }
    ProjectedScan projected = project(scan, sensor_);
    require_directions_of(sensor_, projected.counts, scan.points_m.size(), path);
    RecordedScan result;
    result.name = path;
    result.stamp_s = stamp_s(scan, index);
    result.cloud = std::move(projected.cloud);
    result.counts = projected.counts;
    result.invalid_points = scan.invalid_points;
    return result;
  }

  std::vector<std::string> paths_;
  SensorModel sensor_;
  std::vector<double> stamps_s_;
  std::vector<std::string> warnings_;
  bool times_from_azimuth_;
  AzimuthTimes azimuth_times_;
  std::size_t next_ = 0;
  bool any_used_ = false;
};

}  // namespace

std::unique_ptr<ScanSource> make_file_scan_source(std::vector<std::string> paths,
                                                  const SensorModel& sensor,
                                                  const RecordingOptions& options) {
  return std::make_unique<FileScanSource>(std::move(paths), sensor, options);
}

}  // namespace hqslam
