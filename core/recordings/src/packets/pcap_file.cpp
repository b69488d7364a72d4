#include <fmt/format.h>
#include <pcap.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>

#include "hqslam/core/error.h"
#include "hqslam/recordings/packet.h"
#include "packets/hesai_decoder.h"
#include "packets/ip_datagram.h"
#include "packets/ouster_decoder.h"
#include "packets/robosense_decoder.h"
#include "packets/velodyne_tables.h"
#include "recording_file.h"

namespace hqslam::recordings {

namespace {

constexpr std::uint16_t kIpv4Type = 0x0800;
constexpr std::uint16_t kIpv6Type = 0x86DD;
constexpr std::array<std::uint16_t, 3> kVlanTypes = {0x8100, 0x88A8, 0x9100};

/// The IP packet in a frame whose EtherType stands at `type_at`; tags of virtual networks are
/// skipped. Empty if there is none.
Bytes after_ether_type(Bytes frame, std::size_t type_at) {
  while (frame.size() >= type_at + 2) {
    const std::uint16_t type = big_endian_16(frame, type_at);
    if (type == kIpv4Type || type == kIpv6Type) return frame.subspan(type_at + 2);
    if (std::ranges::find(kVlanTypes, type) == kVlanTypes.end()) break;
    type_at += 4;
  }
  return {};
}

/// The IP packet of a frame of this link layer; empty if there is none.
Bytes ip_packet(Bytes frame, int link_type) {
  switch (link_type) {
    case DLT_EN10MB:
      return after_ether_type(frame, 12);
    case DLT_LINUX_SLL:
      return after_ether_type(frame, 14);
    case DLT_LINUX_SLL2:
      if (frame.size() < 20) return {};
      return big_endian_16(frame, 0) == kIpv4Type || big_endian_16(frame, 0) == kIpv6Type
                 ? frame.subspan(20)
                 : Bytes{};
    case DLT_NULL:
    case DLT_LOOP:
      return frame.size() < 4 ? Bytes{} : frame.subspan(4);
    default:  // raw IP: the constructor refuses all others
      return frame;
  }
}

bool known_link_type(int type) {
  return type == DLT_EN10MB || type == DLT_LINUX_SLL || type == DLT_LINUX_SLL2 ||
         type == DLT_NULL || type == DLT_LOOP || type == DLT_RAW || type == DLT_IPV4 ||
         type == DLT_IPV6;
}

/// A time that no recording has, in a damaged file, is 0.
std::int64_t capture_time_ns(const pcap_pkthdr& header) {
  constexpr std::int64_t kMax_s = 9'000'000'000;
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t seconds = header.ts.tv_sec;
  const std::int64_t fraction_ns = header.ts.tv_usec;  // the file was opened for nanoseconds
  if (seconds < 0 || seconds > kMax_s || fraction_ns < 0 || fraction_ns >= kSecond_ns) return 0;
  return seconds * kSecond_ns + fraction_ns;
}

class PcapFile : public PacketSource {
 public:
  explicit PcapFile(const std::string& path) : path_(path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) {
      throw Error(
          "{}: expected a .pcap or .pcapng file, found no such file; give the path of a capture",
          path);
    }
    bytes_ = static_cast<double>(std::filesystem::file_size(path, error));
    std::array<char, PCAP_ERRBUF_SIZE> complaint{};
    pcap_.reset(pcap_open_offline_with_tstamp_precision(path.c_str(), PCAP_TSTAMP_PRECISION_NANO,
                                                        complaint.data()));
    if (!pcap_) {
      throw Error(
          "{}: expected a .pcap or .pcapng file, found none ({}); record it again with tcpdump or "
          "Wireshark",
          path, complaint.data());
    }
    link_type_ = pcap_datalink(pcap_.get());
    if (!known_link_type(link_type_)) {
      throw Error(
          "{}: expected frames of Ethernet, Linux cooked, loopback or raw IP, found link type {}; "
          "record on such an interface",
          path, link_type_);
    }
  }

  std::optional<Packet> next() override {
    pcap_pkthdr* header = nullptr;
    const std::uint8_t* bytes = nullptr;
    while (failure_.empty()) {
      const int status = pcap_next_ex(pcap_.get(), &header, &bytes);
      if (status == PCAP_ERROR) note_failure();
      if (status != 1) break;
      if (header->caplen < header->len) has_cut_packets_ = true;
      auto packet = datagrams_.add(ip_packet({bytes, header->caplen}, link_type_));
      if (!packet) continue;
      packet->capture_time_ns = capture_time_ns(*header);
      ++packets_;
      return packet;
    }
    return std::nullopt;
  }

  double read_share() const override {
    const long at = std::ftell(pcap_file(pcap_.get()));
    return bytes_ > 0.0 ? std::clamp(static_cast<double>(at) / bytes_, 0.0, 1.0) : 1.0;
  }

  std::string complaint() const override {
    std::string text;
    if (datagrams_.damaged() > 0) {
      text = fmt::format("{} damaged or cut packets were left out{}", datagrams_.damaged(),
                         has_cut_packets_ ? ": tcpdump keeps whole ones with -s 0" : "");
    }
    if (datagrams_.incomplete() > 0) {
      text += fmt::format("{}{} packets of which fragments are missing were left out",
                          text.empty() ? "" : ", ", datagrams_.incomplete());
    }
    if (!failure_.empty()) {
      text += fmt::format("{}it could not be read on behind {} packets ({})",
                          text.empty() ? "" : ", ", packets_, failure_);
    }
    return text;
  }

 private:
  /// Keeps what libpcap cannot read on for. A file that was cut off while it was written just ends.
  void note_failure() {
    const std::string complaint = pcap_geterr(pcap_.get());
    if (complaint.starts_with("truncated")) return;
    failure_ = complaint;
    if (packets_ > 0) return;
    throw Error(
        "{}: expected a .pcap or .pcapng file that can be read, found none of its packets ({}); "
        "write it anew with tcpdump or Wireshark",
        path_, failure_);
  }

  std::string path_;
  double bytes_ = 0.0;
  std::unique_ptr<pcap_t, decltype([](pcap_t* pcap) { pcap_close(pcap); })> pcap_;
  int link_type_ = 0;
  IpDatagrams datagrams_;
  bool has_cut_packets_ = false;  ///< by the snapshot length of the recording program
  std::int64_t packets_ = 0;
  std::string failure_;
};

constexpr std::size_t kVelodynePositionBytes = 512;
constexpr std::uint16_t kVelodynePositionPort = 8308;
/// A capture of more senders and ports than this is of a whole network.
constexpr std::size_t kMaxStreams = 1000;

/// The kind of a packet by its bytes alone; kOther where they do not determine it.
StreamKind kind_of(Bytes payload) {
  if (is_velodyne_packet(payload)) return StreamKind::kVelodynePackets;
  if (hesai_packet(payload)) return StreamKind::kHesaiPackets;
  if (robosense_packet(payload)) return StreamKind::kRobosensePackets;
  return is_settings(payload) ? StreamKind::kSettings : StreamKind::kOther;
}

/// What came from one sender to one port.
struct Traffic {
  std::size_t stream = 0;
  std::map<StreamKind, std::int64_t> packets_of_kind;
  std::map<std::size_t, std::int64_t> packets_of_size;
};

StreamKind kind_of(const Stream& stream, const Traffic& traffic) {
  for (const auto& [kind, packets] : traffic.packets_of_kind) {
    if (kind != StreamKind::kOther && 2 * packets > stream.messages) return kind;
  }
  if (stream.packet_bytes == kVelodynePositionBytes &&
      stream.endpoint.port == kVelodynePositionPort) {
    return StreamKind::kVelodynePositions;
  }
  if (stream.packet_bytes == kOusterImuBytes) return StreamKind::kInertialData;
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
    ++traffic.packets_of_kind[kind_of(packet.payload)];
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

std::unique_ptr<PacketSource> open_pcap(const std::string& path) {
  return std::make_unique<PcapFile>(path);
}

std::unique_ptr<RecordingFile> open_pcap_recording(const std::string& path) {
  return std::make_unique<PcapRecording>(path);
}

}  // namespace hqslam::recordings
