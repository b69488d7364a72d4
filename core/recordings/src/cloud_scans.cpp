#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hqslam/core/error.h"
#include "hqslam/core/projection.h"
#include "hqslam/core/ring_recovery.h"
#include "packet_scans.h"
#include "point_cloud_message.h"
#include "velodyne_sensor.h"

namespace hqslam::recordings {

namespace {

constexpr double kMostForeign = 0.5;
constexpr std::size_t kFewestPointsToJudge = 1000;

/// Scans of a topic of point clouds.
class CloudScans : public ScanSource {
 public:
  CloudScans(std::shared_ptr<const RecordingFile> file, const Stream& stream, std::string path,
             const RecordingInfo& info)
      : file_(std::move(file)),
        messages_(file_->messages(stream)),
        path_(std::move(path)),
        sensor_(info.sensor),
        size_(info.scans),
        warnings_(info.warnings) {}

  const SensorModel& sensor() const override { return sensor_; }
  std::int64_t size() const override { return size_; }
  std::vector<std::string> warnings() const override { return warnings_; }

  std::optional<RecordedScan> next() override {
    const auto message = messages_->next();
    if (!message) return std::nullopt;
    const std::string name = fmt::format("{}[{}]", path_, index_++);
    try {
      return scan_of(*message, name);
    } catch (const Error& error) {
      const std::string text = error.what();
      throw ScanError(text.starts_with(name) ? text : fmt::format("{}: {}", name, text));
    }
  }

 private:
  RecordedScan scan_of(const Message& message, const std::string& name) const {
    PointCloudMessage cloud = read_point_cloud(message, name);
    Scan& scan = cloud.points.scan;
    RecordedScan result;
    result.name = name;
    result.stamp_s = 1e-9 * static_cast<double>(cloud.stamp_ns);
    if (auto times = point_times(cloud.points.time, sensor_.scan_period_s, name)) {
      scan.time_offset_s = std::move(times->offset_s);
      // A scan's stamp is the middle of its times, whatever the driver stamps. Times of a clock
      // other than the stamp's count from the scan's beginning.
      const bool same_clock = std::abs(times->middle_s - result.stamp_s) < 2.0;
      if (times->absolute && same_clock) {
        result.stamp_s = times->middle_s;
      } else if (times->absolute) {
        result.stamp_s -= static_cast<double>(
            *std::min_element(scan.time_offset_s.begin(), scan.time_offset_s.end()));
      } else {
        result.stamp_s += times->middle_s;
      }
    }
    set_rows(cloud.points, name);
    ProjectedScan projected = project(scan, sensor_);
    require_scan_of_sensor(projected.counts, scan.points_m.size(), name);
    result.cloud = std::move(projected.cloud);
    result.counts = projected.counts;
    result.invalid_points = scan.invalid_points;
    return result;
  }

  void set_rows(RawPoints& points, const std::string& name) const {
    Scan& scan = points.scan;
    if (!points.ring.empty()) {
      scan.row = rows_from_rings(points.ring, scan, sensor_, name, points.ring_name);
    } else if (!scan.points_m.empty() && stored_ring_after_ring(scan, sensor_)) {
      scan.row = recover_rings(scan, sensor_).row;
    }
  }

  void require_scan_of_sensor(const ProjectionCounts& counts, std::size_t points,
                              const std::string& name) const {
    if (points < kFewestPointsToJudge) return;
    const double outside = static_cast<double>(counts.outside_rows) / static_cast<double>(points);
    if (outside > kMostForeign) {
      throw Error(
          fmt::format("{}: expected points between the beams of sensor '{}', found {:.0f} % "
                      "outside; name the sensor that recorded the scan",
                      name, sensor_.name, 100.0 * outside));
    }
  }

  std::shared_ptr<const RecordingFile> file_;
  std::unique_ptr<MessageSource> messages_;
  std::string path_;
  SensorModel sensor_;
  std::int64_t size_;
  std::vector<std::string> warnings_;
  std::int64_t index_ = 0;
};

/// Stamps of all messages that can be read, sorted.
std::vector<double> stamps_s(const RecordingFile& file, const Stream& stream) {
  std::vector<double> result;
  const auto messages = file.messages(stream);
  while (const auto message = messages->next()) {
    try {
      result.push_back(1e-9 * static_cast<double>(point_cloud_stamp_ns(*message)));
    } catch (const Error&) {
      continue;  // will be named when it is its turn
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// The time from scan to scan: most gaps are one turn. Nothing with fewer than two stamps.
std::optional<double> period_of(const std::vector<double>& stamps) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(stamps[i] - stamps[i - 1]);
  if (steps.empty()) return std::nullopt;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  if (!(*middle > 0.01 && *middle < 1.0)) return std::nullopt;
  return std::round(1e4 * *middle) * 1e-4;
}

}  // namespace

Opened open_clouds(std::shared_ptr<const RecordingFile> file, const Stream& stream,
                   const std::string& path, const OpenOptions& options) {
  if (options.sensor.empty()) {
    throw Error(
        fmt::format("{}: point clouds do not say which sensor they are of; give --sensor "
                    "NAME or --sensor FILE.json",
                    path));
  }
  Opened opened;
  RecordingInfo& info = opened.info;
  info.sensor = load_sensor(options.sensor);
  const std::vector<double> stamps = stamps_s(*file, stream);
  if (const auto period_s = period_of(stamps)) {
    if (velodyne_model(info.sensor.name) && !options.sensor.ends_with(".json")) {
      info.sensor.columns = columns_at(info.sensor.columns, *period_s);
    }
    info.sensor.scan_period_s = *period_s;
  }
  if (options.columns > 0) info.sensor.columns = options.columns;
  info.scans = stream.messages;
  if (!stamps.empty()) {
    info.first_stamp_s = stamps.front();
    info.duration_s = stamps.back() - stamps.front() + info.sensor.scan_period_s;
  }
  info.has_stamps = true;
  const auto messages = file->messages(stream);
  const auto first = messages->next();
  try {
    if (first)
      info.has_point_times = !read_point_cloud(*first, "PointCloud2").points.time.name.empty();
  } catch (const Error& error) {
    info.warnings.push_back(fmt::format("{}: its first scan: {}", path, error.what()));
  }
  info.format = info.has_point_times ? "point clouds with times" : "point clouds without times";
  opened.source = std::make_unique<CloudScans>(std::move(file), stream, path, info);
  return opened;
}

}  // namespace hqslam::recordings
