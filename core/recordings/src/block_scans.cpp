#include <fmt/format.h>

#include <utility>

#include "hqslam/core/error.h"
#include "lslidar_decoder.h"
#include "point_assembler.h"
#include "robosense_decoder.h"
#include "stream_scans.h"

namespace hqslam::recordings {

namespace {

Bytes settings_of(const StreamReader& reader, const char* maker, int port, std::size_t bytes) {
  const Bytes settings = reader.settings();
  if (settings.size() == bytes) return settings;
  throw Error(
      "{}: expected the settings (DIFOP, port {}) of {} beside its measurements, found none in the "
      "first seconds; record both ports",
      reader.path(), port, maker);
}

/// Of 100 packets, which come 0.6 or 1.2 ms apart, hardly any ends in the first of a second.
bool has_nanoseconds(StreamReader& reader) {
  MessagePackets packets = packets_ahead(reader);
  for (int i = 0; i < 100; ++i) {
    const auto packet = packets.next();
    if (!packet) break;
    const auto said = lslidar_packet(packet->payload);
    if (said && said->is_v4 && said->fraction >= 1'000'000) return true;
  }
  return false;
}

/// name: of the model.
RecordingInfo info_of(const BlockUnit& unit, const char* name, const OpenOptions& options) {
  RecordingInfo info;
  info.sensor = options.sensor.empty() ? unit.sensor : load_sensor(options.sensor);
  info.sensor_known = options.sensor.empty();
  info.sensor.scan_period_s = unit.scan_period_s;
  set_columns(info.sensor, options.columns, options.sensor.empty());
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
  warn_of_other_beams(info.sensor, unit.sensor, path, info.warnings);
  const TurnDecoderOptions decoding = {options.kept_return, with_points};
  return packet_scans(std::move(reader), std::move(info), [=](const SensorModel& sensor) {
    return point_assembler(sensor, path, RobosenseDecoder(unit, sensor, decoding));
  });
}

std::unique_ptr<StreamSource> open_lslidar(StreamReader reader, const OpenOptions& options,
                                           bool with_points) {
  const std::string path = reader.path();
  const LslidarPacket said = first_packet(reader, "an LSLiDAR", lslidar_packet);
  if (said.model != kLslidarC16) {
    throw Error("{}: expected packets of an LSLiDAR C16, found model {:02x}; give its point clouds",
                path, said.model);
  }
  const Bytes settings = settings_of(reader, "the LSLiDAR", 2369, kLslidarSettingsBytes);
  LslidarUnit unit = lslidar_unit(settings, said, path, options.sensor.empty());
  if (has_nanoseconds(reader)) unit.fraction_ns = 1;
  RecordingInfo info = info_of(unit, "LSLiDAR C16", options);
  const TurnDecoderOptions decoding = {options.kept_return, with_points};
  return packet_scans(std::move(reader), std::move(info), [=](const SensorModel& sensor) {
    return point_assembler(sensor, path, LslidarDecoder(unit, sensor, decoding));
  });
}

}  // namespace hqslam::recordings
