#include <fmt/format.h>

#include <utility>

#include "hqslam/core/error.h"
#include "packets/robosense_decoder.h"
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

std::unique_ptr<StreamScans> open_robosense(StreamReader reader, const OpenOptions& options,
                                            bool with_points) {
  const std::string path = reader.path();
  const RobosensePacket said = first_packet(reader, "a RoboSense", robosense_packet);
  const RobosenseUnit unit = robosense_unit(
      settings_of(reader, "the RoboSense", 7788, kRobosenseBytes), said.helios, path);
  RecordingInfo info = info_of(unit, unit.helios ? "RoboSense Helios" : "RoboSense RS-16", options);
  warn_of_other_beams(info.sensor, unit.sensor, path, info.warnings);
  const TurnDecoderOptions decoding = {options.kept_return, with_points};
  return packet_scans(std::move(reader), std::move(info), [=](const SensorModel& sensor) {
    return std::make_unique<RobosenseDecoder>(unit, sensor, decoding, path);
  });
}

}  // namespace hqslam::recordings
