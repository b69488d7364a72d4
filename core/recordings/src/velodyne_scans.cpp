#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hqslam/core/error.h"
#include "hqslam/recordings/scan_assembler.h"
#include "packet_scans.h"
#include "velodyne_sensor.h"

namespace hqslam::recordings {

namespace {

constexpr int kProbedPackets = 20000;

VelodyneStream probe(const RecordingFile& file, const Stream& stream, const std::string& path,
                     std::optional<VelodyneModel> named) {
  VelodyneProbe probe;
  const auto packets = file.packets(stream);
  for (int i = 0; i < kProbedPackets; ++i) {
    const auto packet = packets->next();
    if (!packet) break;
    probe.add(*packet);
  }
  std::optional<VelodyneStream> found;
  try {
    found = probe.result(named);
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

Opened open_velodyne(std::shared_ptr<const RecordingFile> file, const Stream& stream,
                     const std::string& path, const OpenOptions& options) {
  Opened opened;
  RecordingInfo& info = opened.info;
  VelodyneStream velodyne = probe(*file, stream, path, named_model(options.sensor));
  info.sensor = velodyne_sensor(velodyne, options.sensor, options.columns, path, info.warnings);
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
  opened.source = packet_scan_source(std::move(file), stream, info,
                                     velodyne_assembler(velodyne, info.sensor, path, decoding));
  return opened;
}

}  // namespace hqslam::recordings
