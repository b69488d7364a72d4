#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "hqslam/core/error.h"
#include "hqslam/core/projection.h"
#include "packet_scans.h"
#include "velodyne_tables.h"

namespace hqslam::recordings {

namespace {

constexpr int kProbedPackets = 20000;
constexpr double kPresetPeriod_s = 0.1;

class VelodyneScans : public ScanSource {
 public:
  VelodyneScans(std::shared_ptr<const RecordingFile> file, const Stream& stream, std::string path,
                const VelodyneStream& velodyne, const RecordingInfo& info,
                const VelodyneOptions& options)
      : file_(std::move(file)),
        packets_(file_->packets(stream)),
        path_(std::move(path)),
        sensor_(info.sensor),
        size_(info.scans),
        warnings_(info.warnings),
        decoder_(velodyne, info.sensor, options) {}

  const SensorModel& sensor() const override { return sensor_; }
  std::int64_t size() const override { return size_; }
  std::vector<std::string> warnings() const override { return warnings_; }

  std::optional<RecordedScan> next() override {
    while (ready_.empty() && !ended_) {
      if (const auto packet = packets_->next()) {
        decoder_.add(*packet, ready_);
      } else {
        decoder_.finish(ready_);
        ended_ = true;
      }
    }
    if (ready_.empty()) return std::nullopt;
    const Scan scan = std::move(ready_.front());
    ready_.erase(ready_.begin());
    ProjectedScan projected = project(scan, sensor_);
    RecordedScan result;
    result.name = fmt::format("{}[{}]", path_, index_++);
    result.stamp_s = scan.stamp_s;
    result.cloud = std::move(projected.cloud);
    result.counts = projected.counts;
    return result;
  }

 private:
  std::shared_ptr<const RecordingFile> file_;
  std::unique_ptr<PacketSource> packets_;
  std::string path_;
  SensorModel sensor_;
  std::int64_t size_;
  std::vector<std::string> warnings_;
  VelodyneDecoder decoder_;
  std::vector<Scan> ready_;
  std::int64_t index_ = 0;
  bool ended_ = false;
};

VelodyneStream probe(const RecordingFile& file, const Stream& stream, const std::string& path,
                     const SensorModel* wanted) {
  VelodyneProbe probe;
  const auto packets = file.packets(stream);
  for (int i = 0; i < kProbedPackets; ++i) {
    const auto packet = packets->next();
    if (!packet) break;
    probe.add(*packet);
  }
  std::optional<VelodyneStream> found;
  try {
    found = probe.result(wanted != nullptr ? velodyne_model(wanted->name) : std::nullopt);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path, error.what()));
  }
  if (!found) {
    throw Error(
        fmt::format("{}: expected packets of a VLP-16, HDL-32E, VLP-32C or VLS-128, found "
                    "some that say neither by their spacing nor by their factory byte whose "
                    "they are; name the sensor",
                    path));
  }
  return *found;
}

/// The model that has as many lasers as the user's sensor has rows: the one found, if that fits.
VelodyneModel model_for(const SensorModel& sensor, VelodyneModel found, const std::string& path) {
  if (const auto named = velodyne_model(sensor.name)) return *named;
  if (timing(found).lasers == sensor.rows()) return found;
  for (const VelodyneModel model : kVelodyneModels) {
    if (timing(model).lasers == sensor.rows()) return model;
  }
  throw Error(
      fmt::format("{}: expected a sensor of 16, 32 or 128 rows for packets of a {}, found "
                  "'{}' with {}; name the sensor that recorded them",
                  path, name(found), sensor.name, sensor.rows()));
}

/// Columns of a preset for 10 turns a second; a slower head fires more often in a turn.
int columns_at(int preset_columns, double period_s) {
  const double columns = preset_columns * period_s / kPresetPeriod_s;
  return std::clamp(static_cast<int>(std::lround(columns / 100.0)) * 100, 100, 10000);
}

/// The sensor of the stream, whose model may be changed to the user's.
SensorModel sensor_of(VelodyneStream& stream, const OpenOptions& options, const std::string& path,
                      std::vector<std::string>& warnings) {
  SensorModel sensor;
  bool preset = true;
  if (options.sensor.empty()) {
    sensor = sensor_preset(name(stream.model));
    if (stream.factory_model && *stream.factory_model != stream.model) {
      warnings.push_back(fmt::format(
          "{}: the packets' factory bytes say {}, but they are {:.0f} us apart as those of a {}: "
          "taken as that; name the sensor if it is not",
          path, name(*stream.factory_model), stream.packet_spacing_us, name(stream.model)));
    }
  } else {
    sensor = load_sensor(options.sensor);
    preset = !options.sensor.ends_with(".json");
    const VelodyneModel wanted = model_for(sensor, stream.model, path);
    if (wanted != stream.model) {
      warnings.push_back(
          fmt::format("{}: the packets look like those of a {}, but are read as a "
                      "{}'s, as asked for",
                      path, name(stream.model), name(wanted)));
      stream.model = wanted;
    }
  }
  sensor.scan_period_s = std::round(1e4 * stream.scan_period_s) * 1e-4;
  if (options.columns > 0) {
    sensor.columns = options.columns;
  } else if (preset) {
    sensor.columns = columns_at(sensor.columns, sensor.scan_period_s);
  }
  validate(sensor);
  return sensor;
}

/// Goes through the whole stream once without computing points.
void count_scans(const RecordingFile& file, const Stream& stream, const VelodyneStream& velodyne,
                 RecordingInfo& info) {
  VelodyneOptions options;
  options.with_points = false;
  VelodyneDecoder decoder(velodyne, info.sensor, options);
  const auto packets = file.packets(stream);
  std::vector<Scan> scans;
  double last_stamp_s = 0.0;
  const auto take = [&] {
    for (const Scan& scan : scans) {
      if (info.scans == 0) info.first_stamp_s = scan.stamp_s;
      last_stamp_s = scan.stamp_s;
      ++info.scans;
    }
    scans.clear();
  };
  while (const auto packet = packets->next()) {
    decoder.add(*packet, scans);
    take();
  }
  decoder.finish(scans);
  take();
  if (info.scans > 0) {
    info.duration_s = last_stamp_s - info.first_stamp_s + info.sensor.scan_period_s;
  }
  info.packets = decoder.counts();
  info.partial_scans = decoder.partial_scans();
  if (const std::string text = packets->complaint(); !text.empty()) info.warnings.push_back(text);
}

}  // namespace

std::string packet_complaint(const PacketCounts& counts, std::int64_t lost_scans) {
  std::string text;
  const auto say = [&](std::int64_t count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  };
  say(counts.lost, counts.lost == 1 ? "packet was lost" : "packets were lost");
  say(lost_scans, lost_scans == 1 ? "whole turn was lost" : "whole turns were lost");
  say(counts.late, "came late or twice and were left out");
  return text;
}

Opened open_velodyne(std::shared_ptr<const RecordingFile> file, const Stream& stream,
                     const std::string& path, const OpenOptions& options) {
  Opened opened;
  RecordingInfo& info = opened.info;
  std::optional<SensorModel> wanted;
  if (!options.sensor.empty()) wanted = load_sensor(options.sensor);
  VelodyneStream velodyne = probe(*file, stream, path, wanted ? &*wanted : nullptr);
  info.sensor = sensor_of(velodyne, options, path, info.warnings);
  info.sensor_known = options.sensor.empty();
  info.format =
      fmt::format("Velodyne packets, {} return", velodyne.dual_return ? "dual" : "single");
  info.has_stamps = true;
  info.has_point_times = true;
  count_scans(*file, stream, velodyne, info);
  if (info.scans == 0) {
    throw Error(
        fmt::format("{}: expected at least one turn of the sensor, found less than that in "
                    "{} packets; record longer",
                    path, stream.messages));
  }
  if (const std::string text = packet_complaint(info.packets, 0); !text.empty()) {
    info.warnings.push_back(fmt::format("{}: {}", path, text));
  }
  VelodyneOptions decoding;
  decoding.kept_return = options.kept_return;
  opened.source =
      std::make_unique<VelodyneScans>(std::move(file), stream, path, velodyne, info, decoding);
  return opened;
}

}  // namespace hqslam::recordings
