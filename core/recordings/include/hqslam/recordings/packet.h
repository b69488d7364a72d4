#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace hqslam::recordings {

/// The sender of a packet and the port to which it was sent.
struct Endpoint {
  std::array<std::uint8_t, 16> address{};  ///< IPv6, or IPv4 in the last four bytes
  std::uint16_t port = 0;                  ///< the receiver's

  auto operator<=>(const Endpoint&) const = default;
};

/// Whether it is that of an Endpoint with IPv4.
bool is_ipv4(const std::array<std::uint8_t, 16>& address);

/// "192.168.1.201:2368"; IPv6 in brackets.
std::string text(const Endpoint& endpoint);

/// The payload of one UDP datagram, which lives until the next packet is read.
struct Packet {
  std::int64_t capture_time_ns = 0;  ///< since 1970, by the recorder's clock
  Endpoint endpoint;
  std::span<const std::uint8_t> payload;
};

/// Packets in the order in which they were recorded; never more than one in memory.
class PacketSource {
 public:
  virtual ~PacketSource() = default;
  /// The next packet, or nothing at the end. Throws Error for a recording that cannot be read.
  virtual std::optional<Packet> next() = 0;
  /// How much of the recording was read, 0 to 1.
  virtual double read_share() const { return 0.0; }
  /// What was left out, once all packets were read: "" or one line.
  virtual std::string complaint() const { return ""; }
};

/// Where a decoder's packets went.
struct PacketCounts {
  std::int64_t used = 0;
  std::int64_t lost = 0;     ///< never came: gaps in the sensor's own time or count
  std::int64_t late = 0;     ///< doubled or overtaken by a later one: left out
  std::int64_t foreign = 0;  ///< of another size or form: left out
};

/// Of inertial samples: those that were taken in, and those that were not: a number that is not
/// finite, a time that is not later than the one before or that is far from all scans.
struct ImuCounts {
  std::int64_t used = 0;
  std::int64_t left_out = 0;
};

/// The UDP datagrams of a .pcap or .pcapng file (Ethernet with or without VLAN tags, Linux cooked,
/// loopback or raw IP; fragments of IPv4 are put together). Frames other than UDP are skipped. A
/// file that ends within a frame ends before it; where it cannot be read on for another reason it
/// ends there, and complaint() names the reason. Throws Error, also if none of its packets can be
/// read.
std::unique_ptr<PacketSource> open_pcap(const std::string& path);

}  // namespace hqslam::recordings
