#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <utility>

#include "bags/bag.h"
#include "bags/message_packets.h"
#include "bags/point_cloud.h"
#include "bags/whole_turns.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "hqslam/core/median.h"
#include "hqslam/recordings/velodyne.h"
#include "points/azimuth_times.h"
#include "points/recorded_scan.h"
#include "points/ring_numbers.h"
#include "points/sensor_finder.h"
#include "points/thinned_clouds.h"
#include "points/time_check.h"
#include "streams/stream_scans.h"

namespace hqslam::recordings {

namespace {

/// No sensor turns faster.
constexpr double kShortestTurn_s = 0.01;
/// The rate of turning is determined from the stamps of these.
constexpr std::size_t kProbedClouds = 50;
/// The sensor is determined from the points of these.
constexpr std::size_t kCloudsToLearnFrom = 10;
/// A packet of few channels is a message at most as short.
constexpr double kMostInTurn = 200.0;
/// Whether times are a clock's is determined from these.
constexpr std::size_t kTimedClouds = 5;

/// What is known of a topic's clouds before the first scan.
struct CloudForm {
  RingNumbers ring_numbers;
  bool has_clock = false;                   ///< times of points are those of a clock
  double message_s = 0.0;                   ///< from message to message
  std::optional<double> turn_s = {};        ///< where a message is not one turn
  std::optional<CaptureTime> capture = {};  ///< as RecordingOptions has it
  bool with_points = true;                  ///< otherwise scans are timed alone
  bool is_thinned = false;                  ///< read with fewer columns than the sensor's
};

/// Scans of a topic of point clouds.
class CloudScans : public StreamScans {
 public:
  CloudScans(StreamReader reader, RecordingInfo info, CloudForm form)
      : StreamScans(std::move(reader), std::move(info)),
        form_(form),
        turns_(form.turn_s.value_or(0.0)),
        azimuth_times_(info_.sensor.scan_period_s) {}

 private:
  std::optional<RecordedScan> read() override {
    std::optional<RecordedScan> scan = form_.turn_s ? read_turn() : read_message();
    if (scan && form_.with_points && !std::exchange(any_read_, true) && !form_.is_thinned) {
      if (std::string text = fit_warning(*scan, info_.sensor); !text.empty()) {
        info_.warnings.push_back(std::move(text));
      }
    }
    return scan;
  }

  std::string name() { return fmt::format("{}[{}]", reader_.path(), index_++); }

  std::optional<RecordedScan> read_message() {
    const auto message = reader_.next();
    if (!message) return std::nullopt;
    if (index_ == 0) warn_of_missing_stamp(*message);
    return named(name(), [&](const std::string& name) {
      if (form_.with_points)
        return recorded_scan(scan_of_message(*message, name), info_.sensor, name);
      RecordedScan timed;
      timed.name = name;
      timed.stamp_s = point_cloud_stamp_s(*message);
      return timed;
    });
  }

  void warn_of_missing_stamp(const Message& message) {
    try {
      if (MessageReader(message).header().time_ns != 0) return;
    } catch (const Error&) {
      return;  // reported with its scan
    }
    info_.warnings.push_back(
        fmt::format("{}: clouds without stamps are stamped by the time at which they were recorded",
                    reader_.path()));
  }

  std::optional<RecordedScan> read_turn() {
    while (true) {
      if (auto scan = turns_.next()) {
        if (form_.capture == CaptureTime::kMotionCorrected) scan->time_offset_s.clear();
        return named(name(), [&](const std::string& name) {
          return recorded_scan(*scan, info_.sensor, name);
        });
      }
      const auto message = reader_.next();
      if (!message && std::exchange(is_finished_, true)) return std::nullopt;
      if (!message) {
        turns_.finish();
        continue;
      }
      named(reader_.path(), [&](const std::string& name) {
        turns_.add(scan_of_message(*message, name));
        return RecordedScan();
      });
    }
  }

  /// make(name), whose Error is a ScanError that begins with the name.
  template <typename Make>
  static RecordedScan named(const std::string& name, const Make& make) {
    try {
      return make(name);
    } catch (const Error& error) {
      const std::string text = error.what();
      throw ScanError(text.starts_with(name) ? text : fmt::format("{}: {}", name, text));
    }
  }

  Scan scan_of_message(const Message& message, const std::string& name) {
    RawPoints points = read_point_cloud(message, name);
    points.time.is_of_clock = form_.has_clock;
    form_.ring_numbers.count_from_0(points.ring);
    SensorModel sensor = info_.sensor;
    sensor.scan_period_s = form_.message_s;
    Scan scan = scan_of(std::move(points), &sensor, name, point_cloud_stamp_s(message));
    if (!form_.turn_s) set_rows_by_order(scan, info_.sensor, name);
    if (!form_.turn_s && form_.capture == CaptureTime::kMotionCorrected) {
      scan.time_offset_s.clear();
    }
    const std::string text = form_.turn_s ? "" : time_check_.check(scan, form_.message_s);
    if (!text.empty()) info_.warnings.push_back(fmt::format("{}: {}", name, text));
    if (scan.time_offset_s.empty() && form_.capture == CaptureTime::kRolling) {
      const double stamp_s = scan.stamp_s;  // the message's remains
      azimuth_times_.set(scan, info_.sensor, static_cast<std::size_t>(index_));
      scan.stamp_s = stamp_s;
    }
    return scan;
  }

  CloudForm form_;
  WholeTurns turns_;
  TimeCheck time_check_;
  AzimuthTimes azimuth_times_;
  bool any_read_ = false;
  bool is_finished_ = false;
  std::int64_t index_ = 0;
};

/// read(message) of the next messages, this many of them; damaged ones, which are reported when
/// their turn comes, are passed over. Throws Error where all are.
template <typename Read>
auto read_ahead(StreamReader& reader, std::size_t messages, const Read& read) {
  std::vector<decltype(read(Message()))> results;
  std::exception_ptr damage;
  for (std::size_t i = 0; i < messages; ++i) {
    const auto message = reader.ahead(i);
    if (!message) break;
    try {
      results.push_back(read(*message));
    } catch (const Error&) {
      damage = std::current_exception();
    }
  }
  if (results.empty() && damage) std::rethrow_exception(damage);
  return results;
}

/// The time from message to message: most gaps are one turn. Nothing with fewer than two stamps.
std::optional<double> period_s(StreamReader& reader) {
  std::vector<double> stamps = read_ahead(reader, kProbedClouds, point_cloud_stamp_s);
  std::ranges::sort(stamps);
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) steps.push_back(stamps[i] - stamps[i - 1]);
  if (steps.empty()) return std::nullopt;
  const double middle = median(std::move(steps));
  if (!(middle > 0.0005 && middle < 1.0)) return std::nullopt;
  return std::round(1e5 * middle) * 1e-5;
}

std::vector<RawPoints> first_clouds(StreamReader& reader, std::size_t clouds) {
  return read_ahead(reader, clouds, [&](const Message& message) {
    return read_point_cloud(message, reader.path());
  });
}

/// Points and rings of a turn's parts together; one of them may have too few to determine a beam.
std::vector<RawPoints> joined(const std::vector<RawPoints>& parts) {
  RawPoints whole = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const auto& points_m = parts[i].scan.points_m;
    whole.scan.points_m.insert(whole.scan.points_m.end(), points_m.begin(), points_m.end());
    whole.ring.insert(whole.ring.end(), parts[i].ring.begin(), parts[i].ring.end());
  }
  return {whole};
}

bool has_clock(const std::vector<RawPoints>& clouds, double scan_period_s) {
  std::vector<PointTimeField> times;
  for (std::size_t i = 0; i < std::min(kTimedClouds, clouds.size()); ++i) {
    times.push_back(clouds[i].time);
  }
  return times_rise(times, scan_period_s);
}

/// The one that is named, else that of the points.
FoundSensor sensor_of_clouds(const std::vector<RawPoints>& clouds, std::optional<double> period_s,
                             const std::string& name, const std::string& path) {
  const auto find = [&] { return find_sensor(clouds, period_s, path); };
  return name.empty() ? find() : held_against_points(load_sensor(name), found_if_any(find), path);
}

/// Gives the sensor of clouds that were thinned out fewer columns; returns a warning, or "".
std::string fit_columns_to(RawPoints first, const CloudForm& form, const std::string& name,
                           SensorModel& sensor) {
  form.ring_numbers.count_from_0(first.ring);
  first.time = {};
  try {
    Scan scan = scan_of(std::move(first), &sensor, name);
    if (!form.turn_s) set_rows_by_order(scan, sensor, name);
    return fit_columns(recorded_scan(scan, sensor, name).cloud, name, sensor);
  } catch (const Error&) {
    return "";  // reported when its turn comes
  }
}

}  // namespace

std::unique_ptr<StreamScans> open_clouds(StreamReader reader, const OpenOptions& options,
                                         bool with_points) {
  RecordingInfo info;
  const std::vector<RawPoints> first = first_clouds(reader, kCloudsToLearnFrom);
  std::vector<RawPoints> turns = first;
  auto period = period_s(reader);
  CloudForm form;
  if (period) form.turn_s = turn_of_parts_s(first, *period);
  if (form.turn_s) {
    const double in_turn = std::clamp(*form.turn_s / *period, 1.0, kMostInTurn);
    turns = joined(first_clouds(reader, static_cast<std::size_t>(std::ceil(in_turn))));
    info.warnings.push_back(fmt::format(
        "{}: a message holds {:.2g} turns of {:.4g} s: scans are cut by the times of the points",
        reader.path(), *period / *form.turn_s, *form.turn_s));
  }
  if (!form.turn_s && period && *period < kShortestTurn_s) period.reset();
  const auto turn = form.turn_s ? form.turn_s : period;
  FoundSensor chosen = sensor_of_clouds(turns, turn, options.sensor, reader.path());
  info.sensor = std::move(chosen.sensor);
  info.sensor_known = chosen.is_found;
  if (!chosen.note.empty()) {
    info.warnings.push_back(fmt::format("{}: {}", reader.path(), chosen.note));
  }
  const bool named = turn && !options.sensor.empty();
  if (named) info.sensor.scan_period_s = *turn;
  set_columns(info.sensor, options.columns,
              named && velodyne_model(info.sensor.name) && !options.sensor.ends_with(".json"));
  info.has_point_times = !first.empty() && !first.front().time.name.empty();
  info.format = info.has_point_times ? "point clouds with times" : "point clouds without times";
  form.message_s = form.turn_s ? *period : info.sensor.scan_period_s;
  form.with_points = with_points || form.turn_s;
  form.has_clock = form.with_points && has_clock(first, form.message_s);
  form.ring_numbers = ring_numbers(turns, info.sensor);
  form.capture = options.files.capture;
  if (options.columns == 0 && !turns.empty()) {
    std::string text = fit_columns_to(turns.front(), form, reader.path(), info.sensor);
    form.is_thinned = !text.empty();
    if (form.is_thinned) info.warnings.push_back(std::move(text));
  }
  return std::make_unique<CloudScans>(std::move(reader), std::move(info), form);
}

}  // namespace hqslam::recordings
