#include <fmt/format.h>

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
  VelodyneOptions decoding;
  decoding.kept_return = options.kept_return;
  VelodyneOptions counting = decoding;
  counting.with_points = false;
  VelodyneDecoder decoder(velodyne, info.sensor, counting);
  count_scans<Scan>(
      *file, stream, decoder, [](const Scan& scan) { return scan.stamp_s; }, info);
  info.partial_scans = decoder.partial_scans();
  judge_counts(stream, path, info);
  opened.source = packet_scan_source(std::move(file), stream, info,
                                     velodyne_assembler(velodyne, info.sensor, path, decoding));
  return opened;
}

}  // namespace hqslam::recordings
