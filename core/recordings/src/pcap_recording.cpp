#include <map>

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
  std::size_t stream = 0;
  std::int64_t velodyne = 0;
  std::map<std::size_t, std::int64_t> packets_of_size;
};

StreamKind kind_of(const Stream& stream, const Traffic& traffic) {
  if (2 * traffic.velodyne > stream.messages) return StreamKind::kVelodynePackets;
  if (stream.packet_bytes == kVelodynePositionBytes &&
      stream.endpoint.port == kVelodynePositionPort) {
    return StreamKind::kVelodynePositions;
  }
  return stream.packet_bytes >= kSmallestLidarPacket ? StreamKind::kOusterPackets
                                                     : StreamKind::kOther;
}

class PcapRecording : public RecordingFile {
 public:
  explicit PcapRecording(const std::string& path) : packets_(open_pcap(path)) {}

  std::string kind() const override { return "pcap capture"; }
  double read_share() const override { return packets_->read_share(); }
  std::string complaint() const override { return packets_->complaint(); }

  std::optional<Message> next() override {
    while (const auto packet = packets_->next()) {
      if (traffic_.size() == kMaxStreams && !traffic_.contains(packet->endpoint)) continue;
      return Message{packet->capture_time_ns, packet->payload, false, count(*packet)};
    }
    return std::nullopt;
  }

 private:
  /// The stream that the packet is of.
  std::size_t count(const Packet& packet) {
    const auto [found, is_new] = traffic_.try_emplace(packet.endpoint);
    Traffic& traffic = found->second;
    if (is_new) {
      traffic.stream = streams_.size();
      streams_.push_back({.name = text(packet.endpoint), .endpoint = packet.endpoint});
    }
    Stream& stream = streams_[traffic.stream];
    ++stream.messages;
    if (is_velodyne_packet(packet.payload)) ++traffic.velodyne;
    auto& sizes = traffic.packets_of_size;
    const std::size_t bytes = packet.payload.size();
    if (sizes.size() < kMaxStreams || sizes.contains(bytes)) {
      if (++sizes[bytes] > sizes[stream.packet_bytes]) stream.packet_bytes = bytes;
    }
    stream.kind = kind_of(stream, traffic);
    return traffic.stream;
  }

  std::unique_ptr<PacketSource> packets_;
  std::map<Endpoint, Traffic> traffic_;
};

}  // namespace

std::unique_ptr<RecordingFile> open_pcap_recording(const std::string& path) {
  return std::make_unique<PcapRecording>(path);
}

}  // namespace hqslam::recordings
