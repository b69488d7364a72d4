#include <utility>

#include "bag.h"
#include "hqslam/core/excerpt.h"
#include "message_packets.h"
#include "ouster_layout.h"

namespace hqslam::recordings {

namespace {

/// What the messages of a stream are, by this one.
void recognise(Stream& stream, const Message& message) {
  if (plain_type(stream.type) == "sensor_msgs/PointCloud2") {
    stream.kind = StreamKind::kPointClouds;
    return;
  }
  if (stream.packet_bytes > 0 || stream.type.empty() || !carries_packets(stream.type)) return;
  bool given = false;
  MessagePackets packets(stream, [&]() -> std::optional<Message> {
    if (std::exchange(given, true)) return std::nullopt;
    return message;
  });
  const auto packet = packets.next();
  stream.packet_bytes = packet ? packet->payload.size() : 0;
  if (stream.packet_bytes == kVelodynePacketBytes) {
    stream.kind = StreamKind::kVelodynePackets;
  } else if (stream.packet_bytes >= kSmallestLidarPacket &&
             plain_type(stream.type).ends_with("/PacketMsg")) {
    stream.kind = StreamKind::kOusterPackets;
  }
}

class BagRecording : public RecordingFile {
 public:
  BagRecording(std::vector<std::string> paths, std::string kind, OpenBagFile open)
      : paths_(std::move(paths)),
        kind_(std::move(kind)),
        open_(open),
        file_(open(paths_.front())) {}

  std::string kind() const override { return kind_; }

  std::optional<Message> next() override {
    while (true) {
      if (auto message = file_->next()) {
        message->stream = stream_of(static_cast<std::uint32_t>(message->stream));
        Stream& stream = streams_[message->stream];
        ++stream.messages;
        recognise(stream, *message);
        return message;
      }
      if (part_ + 1 == paths_.size()) return std::nullopt;
      file_ = open_(paths_[++part_]);
      stream_of_topic_.clear();
      if (!kept_.empty()) file_->keep_only(kept_);
    }
  }

  void keep_only(std::size_t stream) override {
    kept_ = topics_[stream];
    file_->keep_only(kept_);
  }

  double read_share() const override {
    return (static_cast<double>(part_) + file_->read_share()) / static_cast<double>(paths_.size());
  }

 private:
  /// Topics of one name are one stream, whichever file they are in.
  std::size_t stream_of(std::uint32_t topic) {
    const auto [found, is_new] = stream_of_topic_.try_emplace(topic, streams_.size());
    if (!is_new) return found->second;
    const Topic& of = file_->topics().at(topic);
    for (found->second = 0; found->second < topics_.size(); ++found->second) {
      if (topics_[found->second] == of.name) return found->second;
    }
    topics_.push_back(of.name);
    streams_.push_back(
        {.name = excerpt(of.name, kNameCharacters), .type = excerpt(of.type, kNameCharacters)});
    return found->second;
  }

  std::vector<std::string> paths_;
  std::string kind_;
  OpenBagFile open_;
  std::unique_ptr<BagFile> file_;
  std::size_t part_ = 0;
  std::map<std::uint32_t, std::size_t> stream_of_topic_;  ///< of the file that is open
  std::vector<std::string> topics_;                       ///< their names as the bag has them
  std::string kept_;
};

}  // namespace

std::unique_ptr<RecordingFile> bag_recording(std::vector<std::string> paths, std::string kind,
                                             OpenBagFile open) {
  return std::make_unique<BagRecording>(std::move(paths), std::move(kind), open);
}

}  // namespace hqslam::recordings
