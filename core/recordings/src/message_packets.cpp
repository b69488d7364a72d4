#include "message_packets.h"

#include <fmt/format.h>

#include <utility>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

std::string plain_type(const std::string& type) {
  const std::size_t middle = type.find("/msg/");
  return middle == std::string::npos ? type : type.substr(0, middle) + type.substr(middle + 4);
}

MessagePackets::Carrier MessagePackets::carrier_of(const std::string& type) {
  const std::string plain = plain_type(type);
  if (plain.empty()) return Carrier::kPayload;
  if (plain == "velodyne_msgs/VelodyneScan") return Carrier::kFixedPackets;
  if (plain == "nebula_msgs/NebulaPackets") return Carrier::kPacketLists;
  if (plain.ends_with("/PacketMsg")) return Carrier::kOneBuffer;
  return Carrier::kNone;
}

bool carries_packets(const std::string& type) {
  return MessagePackets::carrier_of(type) != MessagePackets::Carrier::kNone;
}

MessagePackets::MessagePackets(const Stream& stream, NextMessage next_message)
    : carrier_(carrier_of(stream.type)),
      endpoint_(stream.endpoint),
      next_message_(std::move(next_message)) {}

std::optional<Packet> MessagePackets::next() {
  while (true) {
    while (left_ == 0) {
      const auto message = next_message_();
      if (!message) return std::nullopt;
      begin(*message);
    }
    --left_;
    try {
      return packet();
    } catch (const Error&) {
      left_ = 0;
      ++damaged_;
    }
  }
}

void MessagePackets::begin(const Message& message) {
  message_ = message;
  left_ = 1;
  if (carrier_ == Carrier::kPayload) return;
  try {
    reader_.emplace(message);
    if (carrier_ == Carrier::kOneBuffer) return;
    reader_->header_ns();
    left_ = reader_->u32();
  } catch (const Error&) {
    left_ = 0;
    ++damaged_;
  }
}

Packet MessagePackets::packet() {
  Packet result{message_.time_ns, endpoint_, message_.bytes};
  if (carrier_ == Carrier::kPayload) return result;
  if (carrier_ != Carrier::kOneBuffer) {
    const std::int64_t stamp_ns = reader_->time_ns();
    if (stamp_ns > 0) result.capture_time_ns = stamp_ns;
  }
  result.payload = carrier_ == Carrier::kFixedPackets ? reader_->bytes(kVelodynePacketBytes)
                                                      : reader_->byte_list();
  return result;
}

std::string MessagePackets::complaint() const {
  return damaged_ > 0 ? fmt::format("{} damaged messages were left out", damaged_) : "";
}

}  // namespace hqslam::recordings
