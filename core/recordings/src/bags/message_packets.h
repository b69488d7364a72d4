#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "byte_reader.h"
#include "recording_file.h"

namespace hqslam::recordings {

/// The beginning of a stamped message.
struct MessageHeader {
  std::int64_t time_ns = 0;  ///< since 1970
  std::string frame;         ///< its name, without the slash that ROS 1 may put before it
};

/// Reads a message field by field: ROS 2's CDR (little- or big-endian, numbers aligned to their
/// size behind the encapsulation header, texts with a zero at the end) or ROS 1's form (no
/// alignment). Throws Error for a message that ends too early.
/// Source: OMG, "DDS Interoperability Wire Protocol", 10; ROS wiki, "msg".
class MessageReader {
 public:
  explicit MessageReader(const Message& message);

  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::int32_t i32() { return static_cast<std::int32_t>(number(4)); }
  double f64() { return std::bit_cast<double>(number(8)); }
  std::string words();
  /// The bytes of a list that begins with its length.
  Bytes byte_list();
  Bytes bytes(std::size_t count);
  /// A time of seconds and nanoseconds, ns since 1970.
  std::int64_t time_ns();
  MessageHeader header();
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  std::uint64_t number(std::size_t size);

  Bytes bytes_;
  std::size_t begin_ = 0;  ///< of what alignment counts from
  std::size_t at_ = 0;
  bool ros1_ = false;
  bool big_endian_ = false;
};

/// "velodyne_msgs/msg/VelodyneScan" and "velodyne_msgs/VelodyneScan" are one type.
std::string plain_type(const std::string& type);

/// Whether messages of this type carry packets.
bool carries_packets(const std::string& type);

/// The packets that the messages of a stream carry: those of a capture one each.
class MessagePackets {
 public:
  using NextMessage = std::function<std::optional<Message>()>;
  MessagePackets(const Stream& stream, NextMessage next_message);

  /// The next packet, or nothing at the end.
  std::optional<Packet> next();
  /// What was left out, once all packets were read: "" or one line.
  std::string complaint() const;

 private:
  /// How a message carries packets.
  enum class Carrier { kNone, kPayload, kFixedPackets, kSizedPackets, kPacketLists, kOneBuffer };
  static Carrier carrier_of(const std::string& type);
  friend bool carries_packets(const std::string& type);

  void begin(const Message& message);
  Packet packet();

  Carrier carrier_;
  Endpoint endpoint_;
  NextMessage next_message_;
  Message message_;
  std::optional<MessageReader> reader_;
  std::uint32_t left_ = 0;  ///< packets of the message
  std::int64_t damaged_ = 0;
};

/// The first packet that a message of the stream carries; nothing where there is none. It lives as
/// long as the message.
std::optional<Packet> first_packet_of(const Stream& stream, std::optional<Message> message);

}  // namespace hqslam::recordings
