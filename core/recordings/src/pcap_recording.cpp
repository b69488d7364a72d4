#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "hqslam/core/error.h"
#include "ouster_layout.h"
#include "recording_file.h"
#include "velodyne_tables.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kVelodynePositionBytes = 512;
constexpr std::uint16_t kVelodynePositionPort = 8308;
/// A capture of more senders and ports than this is of a whole network.
constexpr std::size_t kMaxStreams = 1000;

/// What came from one sender to one port.
struct Traffic {
  std::int64_t packets = 0;
  std::int64_t velodyne = 0;
  std::map<std::size_t, std::int64_t> sizes;
};

Stream stream_of(const Endpoint& endpoint, const Traffic& traffic) {
  Stream stream;
  stream.name = text(endpoint);
  stream.endpoint = endpoint;
  stream.messages = traffic.packets;
  const auto most =
      std::max_element(traffic.sizes.begin(), traffic.sizes.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  stream.packet_bytes = most->first;
  if (2 * traffic.velodyne > traffic.packets) {
    stream.kind = StreamKind::kVelodynePackets;
  } else if (stream.packet_bytes == kVelodynePositionBytes &&
             endpoint.port == kVelodynePositionPort) {
    stream.kind = StreamKind::kVelodynePositions;
  } else if (stream.packet_bytes >= kSmallestLidarPacket) {
    stream.kind = StreamKind::kOusterPackets;
  }
  return stream;
}

/// The packets of one sender to one port.
class StreamPackets : public PacketSource {
 public:
  StreamPackets(const std::string& path, const Endpoint& endpoint)
      : file_(open_pcap(path)), endpoint_(endpoint) {}

  std::optional<Packet> next() override {
    while (auto packet = file_->next()) {
      if (packet->endpoint == endpoint_) return packet;
    }
    return std::nullopt;
  }
  std::string complaint() const override { return file_->complaint(); }

 private:
  std::unique_ptr<PacketSource> file_;
  Endpoint endpoint_;
};

class PcapRecording : public RecordingFile {
 public:
  explicit PcapRecording(const std::string& path) : path_(path) {
    std::map<Endpoint, Traffic> traffic;
    const auto packets = open_pcap(path);
    while (const auto packet = packets->next()) {
      if (traffic.size() == kMaxStreams && !traffic.contains(packet->endpoint)) continue;
      Traffic& own = traffic[packet->endpoint];
      ++own.packets;
      if (is_velodyne_packet(packet->payload)) ++own.velodyne;
      if (own.sizes.size() < kMaxStreams) ++own.sizes[packet->payload.size()];
    }
    for (const auto& [endpoint, own] : traffic) streams_.push_back(stream_of(endpoint, own));
  }

  std::string kind() const override { return "pcap capture"; }
  const std::vector<Stream>& streams() const override { return streams_; }
  std::unique_ptr<PacketSource> packets(const Stream& stream) const override {
    return std::make_unique<StreamPackets>(path_, stream.endpoint);
  }
  std::unique_ptr<MessageSource> messages(const Stream& stream) const override {
    throw Error(fmt::format("{}: expected messages, found packets in {}", path_, stream.name));
  }

 private:
  std::string path_;
  std::vector<Stream> streams_;
};

}  // namespace

std::unique_ptr<RecordingFile> open_pcap_recording(const std::string& path) {
  return std::make_unique<PcapRecording>(path);
}

}  // namespace hqslam::recordings
