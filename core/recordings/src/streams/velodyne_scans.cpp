#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hqslam/core/error.h"
#include "packets/velodyne_decoder.h"
#include "packets/velodyne_tables.h"
#include "streams/stream_scans.h"

namespace hqslam::recordings {

namespace {

constexpr int kProbedPackets = 20000;

VelodyneStream probe(StreamReader& reader, std::optional<VelodyneModel> named) {
  const std::string& path = reader.path();
  VelodyneProbe probe;
  MessagePackets packets = packets_ahead(reader);
  for (int i = 0; i < kProbedPackets; ++i) {
    const auto packet = packets.next();
    if (!packet) break;
    probe.add(*packet);
  }
  std::optional<VelodyneStream> found;
  try {
    found = probe.result(named);
  } catch (const Error& error) {
    throw Error("{}: {}", path, error.what());
  }
  if (!found) {
    throw Error(
        "{}: expected packets of a VLP-16, HDL-32E, VLP-32C or VLS-128, found some whose "
        "spacing and factory byte determine no model; name the sensor",
        path);
  }
  return *found;
}

/// The model that has as many lasers as the user's sensor has rows: the one found, if that fits.
VelodyneModel model_for(const SensorModel& sensor, VelodyneModel found, const std::string& path) {
  const auto named = velodyne_model(sensor.name);
  if (named && *named != VelodyneModel::kHdl64e) return *named;
  if (timing(found).lasers == sensor.rows()) return found;
  for (const VelodyneModel model : kVelodyneModels) {
    if (timing(model).lasers == sensor.rows()) return model;
  }
  throw Error(
      "{}: expected a sensor of 16, 32 or 128 rows for packets of a {}, found '{}' with {}; name "
      "the sensor that recorded them",
      path, name(found), sensor.name, sensor.rows());
}

void refuse_hdl64e(const VelodyneStream& stream, const std::string& path) {
  if (stream.model != VelodyneModel::kHdl64e) return;
  throw Error(
      "{}: expected packets of a VLP-16, HDL-32E, VLP-32C or VLS-128, found an HDL-64E's, whose "
      "distances mean nothing without the calibration of that unit; give its scans as point clouds",
      path);
}

/// A warning where the factory byte names another sensor than the packets' spacing does. Throws
/// Error for a Puck Hi-Res, which sends the packets of a VLP-16 but has other beams.
void check_factory_byte(const VelodyneStream& stream, const std::string& path,
                        std::vector<std::string>& warnings) {
  constexpr std::uint8_t kPuckHiRes = 0x24;  // source: ros-drivers/velodyne, pull request 127
  if (stream.factory_byte == kPuckHiRes) {
    throw Error(
        "{}: expected packets of a VLP-16, HDL-32E, VLP-32C or VLS-128, found factory byte 0x24 of "
        "a Puck Hi-Res; name a sensor file with its 16 beams from 10 to -10 degrees, 4/3 apart",
        path);
  }
  if (stream.factory_model == stream.model) return;
  warnings.push_back(fmt::format(
      "{}: the packets' factory byte 0x{:02x} is that of {}, but they are {:.0f} us apart as those "
      "of a {}: taken as that; name the sensor if it is not",
      path, stream.factory_byte,
      stream.factory_model ? fmt::format("a {}", name(*stream.factory_model)) : "no known sensor",
      stream.packet_spacing_us, name(stream.model)));
}

}  // namespace

std::unique_ptr<StreamScans> open_velodyne(StreamReader reader, const OpenOptions& options,
                                           bool with_points) {
  const std::string path = reader.path();
  VelodyneStream velodyne = probe(reader, named_model(options.sensor));
  RecordingInfo info;
  info.sensor = velodyne_sensor(velodyne, options.sensor, options.columns, path, info.warnings);
  info.sensor_known = options.sensor.empty();
  info.format =
      fmt::format("Velodyne packets, {} return", velodyne.dual_return ? "dual" : "single");
  const DecoderOptions decoding = {options.kept_return, with_points};
  return packet_scans(std::move(reader), std::move(info), [=](const SensorModel& sensor) {
    return std::make_unique<VelodyneDecoder>(velodyne, sensor, decoding, path);
  });
}

std::optional<VelodyneModel> named_model(const std::string& wanted_sensor) {
  if (wanted_sensor.empty()) return std::nullopt;
  return velodyne_model(load_sensor(wanted_sensor).name);
}

SensorModel velodyne_sensor(VelodyneStream& stream, const std::string& wanted_sensor, int columns,
                            const std::string& path, std::vector<std::string>& warnings) {
  SensorModel sensor;
  bool preset = true;
  if (wanted_sensor.empty()) {
    refuse_hdl64e(stream, path);
    sensor = sensor_preset(name(stream.model));
    check_factory_byte(stream, path, warnings);
  } else {
    sensor = load_sensor(wanted_sensor);
    preset = !wanted_sensor.ends_with(".json");
    const VelodyneModel wanted = model_for(sensor, stream.model, path);
    if (wanted != stream.model) {
      warnings.push_back(
          fmt::format("{}: the packets look like those of a {}, but are read as those of the named "
                      "sensor, a {}",
                      path, name(stream.model), name(wanted)));
      stream.model = wanted;
    }
    refuse_hdl64e(stream, path);
  }
  sensor.scan_period_s = std::round(1e4 * stream.scan_period_s) * 1e-4;
  set_columns(sensor, columns, preset);
  validate(sensor);
  return sensor;
}

}  // namespace hqslam::recordings
