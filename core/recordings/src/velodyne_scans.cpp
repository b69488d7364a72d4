#include <fmt/format.h>

#include <utility>

#include "hqslam/core/error.h"
#include "message_packets.h"
#include "stream_scans.h"
#include "velodyne_sensor.h"

namespace hqslam::recordings {

namespace {

constexpr int kProbedPackets = 20000;

VelodyneStream probe(StreamReader& reader, std::optional<VelodyneModel> named) {
  const std::string& path = reader.path();
  VelodyneProbe probe;
  std::size_t looked_at = 0;
  MessagePackets packets(reader.stream(), [&] { return reader.ahead(looked_at++); });
  for (int i = 0; i < kProbedPackets; ++i) {
    const auto packet = packets.next();
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

std::unique_ptr<StreamSource> open_velodyne(StreamReader reader, const OpenOptions& options,
                                            bool with_points) {
  const std::string path = reader.path();
  VelodyneStream velodyne = probe(reader, named_model(options.sensor));
  RecordingInfo info;
  info.sensor = velodyne_sensor(velodyne, options.sensor, options.columns, path, info.warnings);
  info.sensor_known = options.sensor.empty();
  info.format =
      fmt::format("Velodyne packets, {} return", velodyne.dual_return ? "dual" : "single");
  const VelodyneOptions decoding = {options.kept_return, with_points};
  return packet_scans(std::move(reader), std::move(info), [=](const SensorModel& sensor) {
    return velodyne_assembler(velodyne, sensor, path, decoding);
  });
}

}  // namespace hqslam::recordings
