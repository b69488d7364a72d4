#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/core/recorded_scan.h"
#include "point_cloud_message.h"
#include "stream_scans.h"
#include "velodyne_sensor.h"

namespace hqslam::recordings {

namespace {

/// By whose stamps the rate of turning is told.
constexpr std::size_t kProbedClouds = 50;

/// Scans of a topic of point clouds.
class CloudScans : public StreamScans {
 public:
  CloudScans(StreamReader reader, RecordingInfo info, bool with_points)
      : StreamScans(std::move(reader), std::move(info)), with_points_(with_points) {}

 private:
  std::optional<RecordedScan> read() override {
    const auto message = reader_.next();
    if (!message) return std::nullopt;
    const std::string name = fmt::format("{}[{}]", reader_.path(), index_++);
    try {
      return scan_of_message(*message, name);
    } catch (const Error& error) {
      const std::string text = error.what();
      throw ScanError(text.starts_with(name) ? text : fmt::format("{}: {}", name, text));
    }
  }

  RecordedScan scan_of_message(const Message& message, const std::string& name) const {
    const double stamp_s = 1e-9 * static_cast<double>(point_cloud_stamp_ns(message));
    if (!with_points_) {
      RecordedScan timed;
      timed.stamp_s = stamp_s;
      return timed;
    }
    Scan scan = scan_of(read_point_cloud(message, name), &info_.sensor, name, stamp_s);
    set_rows_by_order(scan, info_.sensor, name);
    return recorded_scan(scan, info_.sensor, name);
  }

  void sensor_changed() override {}
  void complete(RecordingInfo& /*info*/) override {}

  bool with_points_;
  std::int64_t index_ = 0;
};

/// The time from scan to scan: most gaps are one turn. Nothing with fewer than two stamps.
std::optional<double> period_s(StreamReader& reader) {
  std::vector<double> stamps;
  for (std::size_t i = 0; i < kProbedClouds; ++i) {
    const auto message = reader.ahead(i);
    if (!message) break;
    try {
      stamps.push_back(1e-9 * static_cast<double>(point_cloud_stamp_ns(*message)));
    } catch (const Error&) {
      continue;  // will be named when it is its turn
    }
  }
  std::sort(stamps.begin(), stamps.end());
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(stamps[i] - stamps[i - 1]);
  if (steps.empty()) return std::nullopt;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  if (!(*middle > 0.01 && *middle < 1.0)) return std::nullopt;
  return std::round(1e4 * *middle) * 1e-4;
}

bool has_point_times(StreamReader& reader, std::vector<std::string>& warnings) {
  try {
    const auto first = reader.ahead(0);
    return first && !read_point_cloud(*first, "PointCloud2").time.name.empty();
  } catch (const Error& error) {
    warnings.push_back(fmt::format("{}: its first scan: {}", reader.path(), error.what()));
    return false;
  }
}

}  // namespace

std::unique_ptr<StreamSource> open_clouds(StreamReader reader, const OpenOptions& options,
                                          bool with_points) {
  if (options.sensor.empty()) {
    throw Error(
        fmt::format("{}: point clouds do not say which sensor they are of; give --sensor "
                    "NAME or --sensor FILE.json",
                    reader.path()));
  }
  RecordingInfo info;
  info.sensor = load_sensor(options.sensor);
  if (const auto period = period_s(reader)) {
    if (velodyne_model(info.sensor.name) && !options.sensor.ends_with(".json")) {
      info.sensor.columns = columns_at(info.sensor.columns, *period);
    }
    info.sensor.scan_period_s = *period;
  }
  if (options.columns > 0) info.sensor.columns = options.columns;
  info.has_point_times = has_point_times(reader, info.warnings);
  info.format = info.has_point_times ? "point clouds with times" : "point clouds without times";
  return std::make_unique<CloudScans>(std::move(reader), std::move(info), with_points);
}

}  // namespace hqslam::recordings
