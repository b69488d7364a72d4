#include <fmt/format.h>

#include <algorithm>

#include "bag.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "message_reader.h"
#include "ouster_layout.h"
#include "ouster_metadata_text.h"

namespace hqslam::recordings {

namespace {

/// "velodyne_msgs/msg/VelodyneScan" and "velodyne_msgs/VelodyneScan" are one type.
std::string plain_type(const std::string& type) {
  const std::size_t middle = type.find("/msg/");
  return middle == std::string::npos ? type : type.substr(0, middle) + type.substr(middle + 4);
}

/// Of "/rear/lidar_packets": "/rear".
std::string namespace_of(const std::string& topic) {
  const std::size_t last = topic.rfind('/');
  return last == std::string::npos ? "" : topic.substr(0, last);
}

/// How a message carries packets.
enum class Carrier { kNone, kFixedPackets, kPacketLists, kOneBuffer };

Carrier carrier_of(const std::string& type) {
  const std::string plain = plain_type(type);
  if (plain == "velodyne_msgs/VelodyneScan") return Carrier::kFixedPackets;
  if (plain == "nebula_msgs/NebulaPackets") return Carrier::kPacketLists;
  if (plain.ends_with("/PacketMsg")) return Carrier::kOneBuffer;
  return Carrier::kNone;
}

/// The packets that messages carry.
class MessagePackets : public PacketSource {
 public:
  MessagePackets(std::unique_ptr<MessageSource> messages, Carrier carrier)
      : messages_(std::move(messages)), carrier_(carrier) {}

  std::optional<Packet> next() override {
    while (true) {
      while (left_ == 0) {
        const auto message = messages_->next();
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

  std::string complaint() const override {
    return damaged_ > 0 ? fmt::format("{} damaged messages were left out", damaged_) : "";
  }

 private:
  void begin(const Message& message) {
    message_ns_ = message.time_ns;
    try {
      reader_.emplace(message);
      if (carrier_ == Carrier::kOneBuffer) {
        left_ = 1;
        return;
      }
      reader_->header_ns();
      left_ = reader_->u32();
    } catch (const Error&) {
      left_ = 0;
      ++damaged_;
    }
  }

  Packet packet() {
    Packet result;
    result.capture_time_ns = message_ns_;
    if (carrier_ != Carrier::kOneBuffer) {
      const std::int64_t stamp_ns = reader_->time_ns();
      if (stamp_ns > 0) result.capture_time_ns = stamp_ns;
    }
    result.payload = carrier_ == Carrier::kFixedPackets ? reader_->bytes(kVelodynePacketBytes)
                                                        : reader_->byte_list();
    return result;
  }

  std::unique_ptr<MessageSource> messages_;
  Carrier carrier_;
  std::optional<MessageReader> reader_;
  std::int64_t message_ns_ = 0;
  std::uint32_t left_ = 0;
  std::int64_t damaged_ = 0;
};

class BagRecording : public RecordingFile {
 public:
  BagRecording(std::unique_ptr<Bag> bag, std::string path)
      : bag_(std::move(bag)), path_(std::move(path)) {
    for (const Topic& topic : bag_->topics()) streams_.push_back(stream_of(topic));
  }

  std::string kind() const override { return bag_->kind(); }
  const std::vector<Stream>& streams() const override { return streams_; }

  std::unique_ptr<PacketSource> packets(const Stream& stream) const override {
    const Topic& topic = topic_of(stream);
    return std::make_unique<MessagePackets>(bag_->messages(topic.name), carrier_of(topic.type));
  }
  std::unique_ptr<MessageSource> messages(const Stream& stream) const override {
    return bag_->messages(topic_of(stream).name);
  }

  /// Ouster's drivers record them as a text beside the packets: "/rear/metadata" is of
  /// "/rear/lidar_packets". Where there is none such, any sensor's will do.
  std::string ouster_metadata(const Stream& stream) const override {
    const std::string beside = namespace_of(topic_of(stream).name);
    std::string of_another;
    for (const Topic& topic : bag_->topics()) {
      if (plain_type(topic.type) != "std_msgs/String") continue;
      if (topic.name.find("metadata") == std::string::npos) continue;
      std::string text = first_text(topic.name);
      if (!is_ouster_metadata(text)) continue;
      if (namespace_of(topic.name) == beside) return text;
      if (of_another.empty()) of_another = std::move(text);
    }
    return of_another;
  }

 private:
  /// "" for a damaged message: there may be a file beside the bag.
  std::string first_text(const std::string& topic) const {
    const auto messages = bag_->messages(topic);
    const auto message = messages->next();
    if (!message) return "";
    try {
      return MessageReader(*message).words();
    } catch (const Error&) {
      return "";
    }
  }

  const Topic& topic_of(const Stream& stream) const {
    const auto found = std::find_if(streams_.begin(), streams_.end(),
                                    [&](const Stream& other) { return other.name == stream.name; });
    if (found == streams_.end()) {
      throw Error(fmt::format("{}: has no topic {}", path_, excerpt(stream.name, kNameCharacters)));
    }
    return bag_->topics()[static_cast<std::size_t>(found - streams_.begin())];
  }

  Stream stream_of(const Topic& topic) const {
    Stream stream;
    stream.name = excerpt(topic.name, kNameCharacters);
    stream.type = excerpt(topic.type, kNameCharacters);
    stream.messages = topic.messages;
    if (topic.messages == 0) return stream;
    const Carrier carrier = carrier_of(topic.type);
    if (plain_type(topic.type) == "sensor_msgs/PointCloud2") {
      stream.kind = StreamKind::kPointClouds;
    } else if (carrier != Carrier::kNone) {
      MessagePackets packets(bag_->messages(topic.name), carrier);
      const auto packet = packets.next();
      stream.packet_bytes = packet ? packet->payload.size() : 0;
      if (stream.packet_bytes == kVelodynePacketBytes) {
        stream.kind = StreamKind::kVelodynePackets;
      } else if (carrier == Carrier::kOneBuffer && stream.packet_bytes >= kSmallestLidarPacket) {
        stream.kind = StreamKind::kOusterPackets;
      }
    }
    return stream;
  }

  std::unique_ptr<Bag> bag_;
  std::string path_;
  std::vector<Stream> streams_;
};

class ChainedMessages : public MessageSource {
 public:
  explicit ChainedMessages(std::vector<std::unique_ptr<MessageSource>> parts)
      : parts_(std::move(parts)) {}
  std::optional<Message> next() override {
    for (; part_ < parts_.size(); ++part_) {
      if (auto message = parts_[part_]->next()) return message;
    }
    return std::nullopt;
  }

 private:
  std::vector<std::unique_ptr<MessageSource>> parts_;
  std::size_t part_ = 0;
};

class ChainedBag : public Bag {
 public:
  explicit ChainedBag(std::vector<std::unique_ptr<Bag>> bags) : bags_(std::move(bags)) {
    for (const auto& bag : bags_) {
      for (const Topic& topic : bag->topics()) add_topic(topics_, topic);
    }
  }
  std::string kind() const override { return bags_.front()->kind(); }
  const std::vector<Topic>& topics() const override { return topics_; }
  std::unique_ptr<MessageSource> messages(const std::string& topic) const override {
    std::vector<std::unique_ptr<MessageSource>> parts;
    for (const auto& bag : bags_) parts.push_back(bag->messages(topic));
    return std::make_unique<ChainedMessages>(std::move(parts));
  }

 private:
  std::vector<std::unique_ptr<Bag>> bags_;
  std::vector<Topic> topics_;
};

}  // namespace

void add_topic(std::vector<Topic>& topics, const Topic& topic) {
  const auto known = std::find_if(topics.begin(), topics.end(),
                                  [&](const Topic& other) { return other.name == topic.name; });
  if (known == topics.end()) {
    topics.push_back(topic);
  } else {
    known->messages += topic.messages;
  }
}

std::unique_ptr<Bag> chained(std::vector<std::unique_ptr<Bag>> bags) {
  if (bags.size() == 1) return std::move(bags.front());
  return std::make_unique<ChainedBag>(std::move(bags));
}

std::unique_ptr<RecordingFile> bag_recording(std::unique_ptr<Bag> bag, const std::string& path) {
  return std::make_unique<BagRecording>(std::move(bag), path);
}

}  // namespace hqslam::recordings
