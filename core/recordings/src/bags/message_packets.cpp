#include "bags/message_packets.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hqslam/core/error.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kEncapsulation = 4;
/// Room for any packet of a Hesai.
constexpr std::size_t kPandarPacketBytes = 1500;

[[noreturn]] void fail_for_end(std::size_t wanted, std::size_t left) {
  throw Error(
      "expected {} more bytes of a message, found {}: the message is damaged or of another type "
      "than the file says",
      wanted, left);
}

}  // namespace

std::string plain_type(const std::string& type) {
  const std::size_t middle = type.find("/msg/");
  return middle == std::string::npos ? type : type.substr(0, middle) + type.substr(middle + 4);
}

MessagePackets::Carrier MessagePackets::carrier_of(const std::string& type) {
  const std::string plain = plain_type(type);
  if (plain.empty()) return Carrier::kPayload;
  if (plain == "velodyne_msgs/VelodyneScan") return Carrier::kFixedPackets;
  if (plain == "pandar_msgs/PandarScan") return Carrier::kSizedPackets;
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

std::optional<Packet> first_packet_of(const Stream& stream, std::optional<Message> message) {
  return MessagePackets(stream, [&] { return std::exchange(message, std::nullopt); }).next();
}

void MessagePackets::begin(const Message& message) {
  message_ = message;
  left_ = 1;
  if (carrier_ == Carrier::kPayload) return;
  try {
    reader_.emplace(message);
    if (carrier_ == Carrier::kOneBuffer) return;
    reader_->header();
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
  if (carrier_ == Carrier::kSizedPackets) {
    const Bytes space = reader_->bytes(kPandarPacketBytes);
    result.payload = space.first(std::min<std::size_t>(reader_->u32(), space.size()));
    return result;
  }
  result.payload = carrier_ == Carrier::kFixedPackets ? reader_->bytes(kVelodynePacketBytes)
                                                      : reader_->byte_list();
  return result;
}

std::string MessagePackets::complaint() const {
  return damaged_ > 0 ? fmt::format("{} damaged messages were left out", damaged_) : "";
}

MessageReader::MessageReader(const Message& message) : bytes_(message.bytes), ros1_(message.ros1) {
  if (ros1_) return;
  if (bytes_.size() < kEncapsulation) fail_for_end(kEncapsulation, bytes_.size());
  big_endian_ = (bytes_[1] & 1U) == 0;
  begin_ = kEncapsulation;
  at_ = kEncapsulation;
}

std::uint64_t MessageReader::number(std::size_t size) {
  if (!ros1_) at_ += (size - (at_ - begin_) % size) % size;
  if (at_ > bytes_.size() || bytes_.size() - at_ < size) {
    fail_for_end(size, at_ > bytes_.size() ? 0 : bytes_.size() - at_);
  }
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t from = big_endian_ ? i : size - 1 - i;
    value = value << 8U | bytes_[at_ + from];
  }
  at_ += size;
  return value;
}

Bytes MessageReader::bytes(std::size_t count) {
  if (left() < count) fail_for_end(count, left());
  const Bytes result = bytes_.subspan(at_, count);
  at_ += count;
  return result;
}

Bytes MessageReader::byte_list() { return bytes(u32()); }

std::string MessageReader::words() {
  const Bytes characters = byte_list();
  std::string text(characters.begin(), characters.end());
  if (!ros1_ && !text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::int64_t MessageReader::time_ns() {
  const std::int64_t seconds = ros1_ ? std::int64_t{u32()} : std::int64_t{i32()};
  return seconds * 1'000'000'000 + u32();
}

MessageHeader MessageReader::header() {
  if (ros1_) u32();  // a running number
  MessageHeader result;
  result.time_ns = time_ns();
  result.frame = words();
  if (result.frame.starts_with('/')) result.frame.erase(0, 1);
  return result;
}

}  // namespace hqslam::recordings
