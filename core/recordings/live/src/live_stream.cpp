#include "live_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hqslam/core/error.h"
#include "http_get.h"
#include "packets/ouster_decoder.h"
#include "packets/ouster_metadata.h"
#include "packets/velodyne_decoder.h"
#include "packets/velodyne_tables.h"

namespace hqslam::live {

using namespace recordings;

namespace {

constexpr std::uint16_t kVelodynePort = 2368;
constexpr std::uint16_t kOusterPort = 7502;
constexpr std::uint16_t kOusterImuPort = 7503;
/// From firmware 2.2 on; older sensors' metadata must be given as a file.
constexpr const char* kMetadataPath = "/api/v1/sensor/metadata";
/// A Velodyne is recognized by half a second of packets, or this many if their clock stands still.
constexpr std::int64_t kProbed_us = 500'000;
constexpr std::int64_t kMostProbedPackets = 5000;
/// Most addresses that are distinguished; the one that sends least makes room for a new one.
constexpr std::size_t kMostSenders = 16;
/// Memory of an address and its packets.
constexpr auto packets_of = [](const auto& sender) { return sender.second.packets; };
/// A sender that gave no metadata is not asked again so soon.
constexpr std::int64_t kAskAgain_ns = 5'000'000'000;
/// After kSilence_ns the sensor may have another address: one that has sent for kHeir_ns.
constexpr std::int64_t kSilence_ns = 1'000'000'000;
constexpr std::int64_t kHeir_ns = 500'000'000;
constexpr std::int64_t kHeirPackets = 10;

}  // namespace

LiveStream::LiveStream(const LiveOptions& options) : options_(options) {
  named_ = load_sensor(options.sensor);
  if (!options.sensor.ends_with(".json")) {
    is_ouster_ = named_.name.starts_with("os");
    if (named_model(options.sensor) == recordings::VelodyneModel::kHdl64e) {
      throw Error(
          "{}: expected a sensor whose packets are read, found an HDL-64E, whose distances mean "
          "nothing without the calibration of that unit; record it and run its point clouds",
          options.sensor);
    }
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

std::uint16_t LiveStream::imu_port() const {
  if (!metadata_) return 0;
  return metadata_->imu_port != 0 ? metadata_->imu_port : kOusterImuPort;
}

bool LiveStream::is_imu(const Packet& packet) const {
  return packet.payload.size() == kOusterImuBytes && packet.endpoint.address == sender_->address;
}

LiveStream::Sender& LiveStream::heard(const Packet& packet) {
  if (!senders_.contains(packet.endpoint) && senders_.size() == kMostSenders) {
    senders_.erase(std::ranges::min_element(senders_, {}, packets_of));
  }
  Sender& sender = senders_[packet.endpoint];
  ++sender.packets;
  sender.last_bytes = packet.payload.size();
  if (understood(packet) && sender.understood++ == 0) sender.first_ns = packet.capture_time_ns;
  return sender;
}

/// Whether the packet may be the sensor's, as far as that is known.
bool LiveStream::understood(const Packet& packet) const {
  if (!is_ouster_) return is_velodyne_packet(packet.payload);
  if (!metadata_) return packet.payload.size() >= kSmallestLidarPacket;
  if (packet.payload.size() != metadata_->packet_bytes()) return false;
  const std::uint64_t serial = serial_number(packet.payload, metadata_->profile);
  return serial_number_ == 0 || serial == 0 || serial == serial_number_;
}

bool LiveStream::recognize(const Packet& packet) {
  Sender& sender = heard(packet);
  if (!understood(packet)) return false;
  const bool recognized =
      is_ouster_ ? recognize_ouster(packet, sender) : recognize_velodyne(packet, sender);
  if (!recognized) return false;
  sender_ = packet.endpoint;
  last_ns_ = packet.capture_time_ns;
  senders_.clear();
  return true;
}

std::string LiveStream::complaint() const {
  const auto most = std::ranges::max_element(senders_, {}, packets_of);
  if (most == senders_.end()) return "";
  const auto& [endpoint, sender] = *most;
  if (!sender.complaint.empty()) return sender.complaint;
  if (sender.understood > 0) return "";
  const std::string size = metadata_ ? fmt::format(" of {} bytes", metadata_->packet_bytes()) : "";
  return fmt::format(
      "UDP port {}: expected packets{} of '{}', found some of {} bytes from {}; name the sensor "
      "that sends them, or its port",
      endpoint.port, size, options_.sensor, sender.last_bytes, text(endpoint));
}

bool LiveStream::ask_for_metadata(const Packet& packet, Sender& sender) {
  const std::int64_t now_ns = packet.capture_time_ns;
  if (sender.asked_ns != 0 && now_ns - sender.asked_ns < kAskAgain_ns) return false;
  sender.asked_ns = now_ns;
  const std::string place = text(Endpoint{packet.endpoint.address, options_.http_port});
  std::string answer;
  OusterMetadata metadata;
  try {
    answer = http_get(packet.endpoint.address, options_.http_port, kMetadataPath);
    metadata = ouster_metadata_from_json(answer, place);
  } catch (const Error& error) {
    sender.complaint =
        fmt::format("no metadata from the sensor ({}); give them as a .json file", error.what());
    return false;
  }
  if (metadata.sensor.rows() != named_.rows()) {
    sender.complaint = fmt::format(
        "{}: is a sensor of {} beams, expected the {} of '{}'; name the kind that it is", place,
        metadata.sensor.rows(), named_.rows(), options_.sensor);
    return false;
  }
  metadata_ = std::move(metadata);
  metadata_text_ = std::move(answer);
  return true;
}

bool LiveStream::recognize_ouster(const Packet& packet, Sender& sender) {
  if (!metadata_ && !ask_for_metadata(packet, sender)) return false;
  if (packet.payload.size() != metadata_->packet_bytes()) return false;
  sensor_ = metadata_->sensor;
  format_ = fmt::format("Ouster packets, {}", name(metadata_->profile));
  const std::uint64_t serial = serial_number(packet.payload, metadata_->profile);
  if (serial == metadata_->serial_number) {
    serial_number_ = serial;
  } else if (serial != 0 && metadata_->serial_number != 0) {
    warnings_.push_back(fmt::format(
        "packets of sensor {}, but {} is of sensor {}: its beams may be off by tenths of a degree",
        serial, options_.sensor, metadata_->serial_number));
  }
  return true;
}

bool LiveStream::recognize_velodyne(const Packet& packet, Sender& sender) {
  sender.probe.add(packet);
  const std::int64_t now_us = little_endian<std::uint32_t>(packet.payload, kTimeAt);
  // The sensor's hour may be over.
  if (!sender.first_us || now_us < *sender.first_us) sender.first_us = now_us;
  const bool enough = sender.understood % kMostProbedPackets == 0;
  if (now_us - *sender.first_us < kProbed_us && !enough) return false;
  try {
    velodyne_ = sender.probe.result(named_model(options_.sensor));
    if (!velodyne_) return false;
    sensor_ = velodyne_sensor(*velodyne_, options_.sensor, 0,
                              fmt::format("UDP port {}", packet.endpoint.port), warnings_);
  } catch (const Error& error) {
    sender.complaint = error.what();
    return false;
  }
  format_ = fmt::format("Velodyne packets, {} return", velodyne_->dual_return ? "dual" : "single");
  return true;
}

bool LiveStream::is_sensors(const Packet& packet) {
  const std::int64_t now_ns = packet.capture_time_ns;
  if (packet.endpoint == *sender_) {
    if (understood(packet)) {
      last_ns_ = now_ns;
      senders_.clear();
    }
    return true;
  }
  const Sender& other = heard(packet);
  if (!understood(packet) || now_ns - last_ns_ < kSilence_ns ||
      now_ns - other.first_ns < kHeir_ns || other.understood < kHeirPackets) {
    return false;
  }
  sender_ = packet.endpoint;
  last_ns_ = now_ns;
  senders_.clear();
  return true;
}

std::unique_ptr<ScanAssembler> LiveStream::assembler(int columns) {
  const DecoderOptions options = {options_.kept_return, true, serial_number_};
  if (is_ouster_) {
    if (columns > 0 && columns != sensor_.columns) {
      throw Error(
          "expected the {} columns a turn that the sensor sends, found {}; set it to another mode",
          sensor_.columns, columns);
    }
    return std::make_unique<OusterDecoder>(*metadata_, options, "live");
  }
  if (columns > 0) sensor_.columns = columns;
  return std::make_unique<VelodyneDecoder>(*velodyne_, sensor_, options, "live");
}

}  // namespace hqslam::live
