#include <fmt/format.h>

#include <utility>

#include "hqslam/core/error.h"
#include "robosense_decoder.h"
#include "stream_scans.h"
#include "velodyne_sensor.h"

namespace hqslam::recordings {

namespace {

bool is_helios(StreamReader& reader) {
  MessagePackets packets = packets_ahead(reader);
  while (const auto packet = packets.next()) {
    if (const auto said = robosense_packet(packet->payload)) return said->helios;
  }
  throw Error("{}: expected packets of a RoboSense, found none that are whole; copy it again",
              reader.path());
}

}  // namespace

std::unique_ptr<StreamSource> open_robosense(StreamReader reader, const OpenOptions& options,
                                             bool with_points) {
  const std::string path = reader.path();
  if (reader.robosense_settings().empty()) {
    throw Error(
        "{}: expected the settings (DIFOP, port 7788) of the RoboSense beside its measurements, "
        "found none in the first seconds; record both ports",
        path);
  }
  const RobosenseUnit unit = robosense_unit(reader.robosense_settings(), is_helios(reader), path);
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
  info.format =
      fmt::format("RoboSense {} packets, {} beams, {} return", unit.helios ? "Helios" : "RS-16",
                  unit.sensor.rows(), unit.dual_return ? "dual" : "single");
  const VelodyneOptions decoding = {options.kept_return, with_points};
  return packet_scans(std::move(reader), std::move(info), [=](const SensorModel& sensor) {
    return robosense_assembler(unit, sensor, path, decoding);
  });
}

}  // namespace hqslam::recordings
