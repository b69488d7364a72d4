#include "live_stream.h"

#include <fmt/format.h>

#include "hqslam/core/error.h"
#include "http_get.h"
#include "ouster_layout.h"
#include "ouster_metadata_text.h"
#include "velodyne_sensor.h"
#include "velodyne_tables.h"

namespace hqslam::live {

using namespace recordings;

namespace {

constexpr std::uint16_t kVelodynePort = 2368;
constexpr std::uint16_t kOusterPort = 7502;
/// From firmware 2.2 on; older sensors' metadata must be given as a file.
constexpr const char* kMetadataPath = "/api/v1/sensor/metadata";
/// What a Velodyne is recognised by: half a second, or so many packets if their clock stands still.
constexpr std::int64_t kProbed_us = 500'000;
constexpr std::int64_t kMostProbedPackets = 5000;
/// So many packets of which none is the sensor's, and none will be.
constexpr std::int64_t kMostForeignPackets = 200;

}  // namespace

LiveStream::LiveStream(const LiveOptions& options) : options_(options) {
  if (options.sensor.ends_with(".xml")) {
    named_ = sensor_of(read_velodyne_calibration(options.sensor));
    return;
  }
  named_ = load_sensor(options.sensor);
  if (!options.sensor.ends_with(".json")) {
    is_ouster_ = named_.name.starts_with("os");
    return;
  }
  std::string text = ouster_metadata_text(options.sensor);
  if (!is_ouster_metadata(text)) return;
  is_ouster_ = true;
  metadata_ = ouster_metadata_from_json(text, options.sensor);
  metadata_text_ = std::move(text);
}

std::uint16_t LiveStream::usual_port() const {
  if (!is_ouster_) return kVelodynePort;
  return metadata_ && metadata_->lidar_port != 0 ? metadata_->lidar_port : kOusterPort;
}

bool LiveStream::recognise(const Packet& packet) {
  ++packets_;
  const bool recognised = is_ouster_ ? recognise_ouster(packet) : recognise_velodyne(packet);
  if (!recognised && !sender_ && packets_ >= kMostForeignPackets) fail_for_packets(packet);
  return recognised;
}

void LiveStream::ask_for_metadata(const Packet& packet) {
  const std::string place = text(Endpoint{packet.endpoint.address, options_.http_port});
  std::string answer;
  OusterMetadata metadata;
  try {
    answer = http_get(packet.endpoint.address, options_.http_port, kMetadataPath);
    metadata = ouster_metadata_from_json(answer, place);
  } catch (const Error& error) {
    throw Error(
        fmt::format("no metadata from the sensor ({}); give them as a .json file", error.what()));
  }
  if (metadata.sensor.rows() != named_.rows()) {
    throw Error(
        fmt::format("{}: is a sensor of {} beams, expected the {} of '{}'; name the kind "
                    "that it is",
                    place, metadata.sensor.rows(), named_.rows(), options_.sensor));
  }
  metadata_ = std::move(metadata);
  metadata_text_ = std::move(answer);
}

bool LiveStream::recognise_ouster(const Packet& packet) {
  if (packet.payload.size() < kSmallestLidarPacket) return false;
  if (!metadata_) ask_for_metadata(packet);
  if (packet.payload.size() != metadata_->packet_bytes()) return false;
  sender_ = packet.endpoint;
  sensor_ = metadata_->sensor;
  format_ = fmt::format("Ouster packets, {}", name(metadata_->profile));
  serial_number_ = serial_number(packet.payload, metadata_->profile);
  if (serial_number_ != 0 && metadata_->serial_number != 0 &&
      serial_number_ != metadata_->serial_number) {
    warnings_.push_back(fmt::format(
        "packets of sensor {}, but {} is of sensor {}: its beams may be off by tenths of a degree",
        serial_number_, options_.sensor, metadata_->serial_number));
  }
  return true;
}

bool LiveStream::recognise_velodyne(const Packet& packet) {
  if (!is_velodyne_packet(packet.payload)) return false;
  if (!sender_) sender_ = packet.endpoint;
  probe_.add(packet);
  const std::int64_t now_us = little_endian<std::uint32_t>(packet.payload, kTimeAt);
  if (!first_us_ || now_us < *first_us_) first_us_ = now_us;  // the sensor's hour was over
  if (now_us - *first_us_ < kProbed_us && packets_ < kMostProbedPackets) return false;
  velodyne_ = probe_.result(named_model(options_.sensor));
  if (!velodyne_) fail_for_packets(packet);
  sensor_ = velodyne_sensor(*velodyne_, options_.sensor, 0,
                            fmt::format("UDP port {}", packet.endpoint.port), warnings_);
  format_ = fmt::format("Velodyne packets, {} return", velodyne_->dual_return ? "dual" : "single");
  return true;
}

void LiveStream::fail_for_packets(const Packet& packet) const {
  const std::string size = metadata_ ? fmt::format(" of {} bytes", metadata_->packet_bytes()) : "";
  throw Error(fmt::format(
      "UDP port {}: expected packets{} of '{}', found some of {} bytes from {}; name "
      "the sensor that sends them, or its port",
      packet.endpoint.port, size, options_.sensor, packet.payload.size(), text(packet.endpoint)));
}

std::unique_ptr<ScanAssembler> LiveStream::assembler(int columns) {
  if (is_ouster_) {
    if (columns > 0 && columns != sensor_.columns) {
      throw Error(
          fmt::format("the sensor sends {} columns a turn, {} are asked for; set it to "
                      "another mode",
                      sensor_.columns, columns));
    }
    OusterOptions options;
    options.kept_return = options_.kept_return;
    options.serial_number = serial_number_;
    return ouster_assembler(*metadata_, "live", options);
  }
  if (columns > 0) sensor_.columns = columns;
  VelodyneOptions options;
  options.kept_return = options_.kept_return;
  return velodyne_assembler(*velodyne_, sensor_, "live", options);
}

}  // namespace hqslam::live
