#include <fmt/format.h>

#include <utility>

#include "hqslam/core/error.h"
#include "packets/robosense_decoder.h"
#include "streams/stream_scans.h"

namespace hqslam::recordings {

namespace {

/// The sensor of this unit, or the one that is named.
SensorModel sensor_of(const RobosenseUnit& unit, const OpenOptions& options,
                      const std::string& path, std::vector<std::string>& warnings) {
  SensorModel sensor = options.sensor.empty() ? unit.sensor : load_sensor(options.sensor);
  sensor.scan_period_s = unit.sensor.scan_period_s;
  set_columns(sensor, options.columns, options.sensor.empty());
  validate(sensor);
  warn_of_other_beams(sensor, unit.sensor, path, warnings);
  return sensor;
}

}  // namespace

std::unique_ptr<StreamScans> open_robosense(StreamReader reader, const OpenOptions& options,
                                            bool with_points) {
  const std::string path = reader.path();
  const RobosensePacket header = first_packet(reader, "a RoboSense", robosense_packet);
  if (reader.settings().size() != kRobosenseBytes) {
    throw Error(
        "{}: expected the settings (DIFOP, port 7788) of the RoboSense beside its measurements, "
        "found none in the first seconds; record both ports",
        path);
  }
  const RobosenseUnit unit = robosense_unit(reader.settings(), header.helios, path);
  RecordingInfo info;
  info.sensor = sensor_of(unit, options, path, info.warnings);
  info.sensor_known = options.sensor.empty();
  info.format =
      fmt::format("RoboSense {} packets, {} beams, {} return", unit.helios ? "Helios" : "RS-16",
                  unit.sensor.rows(), unit.dual_return ? "dual" : "single");
  const DecoderOptions decoding = {options.kept_return, with_points};
  return packet_scans(std::move(reader), std::move(info), [=](const SensorModel& sensor) {
    return std::make_unique<RobosenseDecoder>(unit, sensor, decoding, path);
  });
}

}  // namespace hqslam::recordings
