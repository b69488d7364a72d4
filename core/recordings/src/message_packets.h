#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "message_reader.h"
#include "recording_file.h"

namespace hqslam::recordings {

/// "velodyne_msgs/msg/VelodyneScan" and "velodyne_msgs/VelodyneScan" are one type.
std::string plain_type(const std::string& type);

/// Whether messages of this type carry packets.
bool carries_packets(const std::string& type);

/// The packets that the messages of a stream carry: those of a capture one each.
class MessagePackets : public PacketSource {
 public:
  using NextMessage = std::function<std::optional<Message>()>;
  MessagePackets(const Stream& stream, NextMessage next_message);

  std::optional<Packet> next() override;
  std::string complaint() const override;

 private:
  /// How a message carries packets.
  enum class Carrier { kNone, kPayload, kFixedPackets, kPacketLists, kOneBuffer };
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

}  // namespace hqslam::recordings
