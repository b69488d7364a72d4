#include <fmt/format.h>

#include <utility>

#include "hqslam/core/error.h"
#include "robosense_decoder.h"
#include "stream_scans.h"
#include "velodyne_sensor.h"

namespace hqslam::recordings {

namespace {

/// What read(payload) says of the first packet that it understands.
template <typename Read>
auto first_packet(StreamReader& reader, const char* maker, const Read& read) {
  MessagePackets packets = packets_ahead(reader);
  while (const auto packet = packets.next()) {
    if (const auto said = read(packet->payload)) return *said;
  }
  throw Error("{}: expected packets of {}, found none that are whole; copy it again", reader.path(),
              maker);
}

Bytes settings_of(const StreamReader& reader, const char* maker, int port, std::size_t bytes) {
  const Bytes settings = reader.settings();
  if (settings.size() == bytes) return settings;
  throw Error(
      "{}: expected the settings (DIFOP, port {}) of {} beside its measurements, found none in the "
      "first seconds; record both ports",
      reader.path(), port, maker);
}

/// name: of the model.
RecordingInfo info_of(const BlockUnit& unit, const char* name, const OpenOptions& options) {
  RecordingInfo info;
  info.sensor = options.sensor.empty() ? unit.sensor : load_sensor(options.sensor);
  info.sensor_known = options.sensor.empty();
  info.sensor.scan_period_s = unit.scan_period_s;
  if (options.columns > 0) {
    info.sensor.columns = options.columns;
  } else if (options.sensor.empty()) {
    info.sensor.columns = columns_at(info.sensor.columns, unit.scan_period_s);
  }
  validate(info.sensor);
  info.format = fmt::format("{} packets, {} beams, {} return", name, unit.sensor.rows(),
                            unit.dual_return ? "dual" : "single");
  return info;
}

}  // namespace

std::unique_ptr<StreamSource> open_robosense(StreamReader reader, const OpenOptions& options,
                                             bool with_points) {
  const std::string path = reader.path();
  const RobosensePacket said = first_packet(reader, "a RoboSense", robosense_packet);
  const RobosenseUnit unit = robosense_unit(
      settings_of(reader, "the RoboSense", 7788, kRobosenseBytes), said.helios, path);
  RecordingInfo info = info_of(unit, unit.helios ? "RoboSense Helios" : "RoboSense RS-16", options);
  const VelodyneOptions decoding = {options.kept_return, with_points};
  return packet_scans(std::move(reader), std::move(info), [=](const SensorModel& sensor) {
    return robosense_assembler(unit, sensor, path, decoding);
  });
}

}  // namespace hqslam::recordings
