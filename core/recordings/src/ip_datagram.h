#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "byte_reader.h"
#include "hqslam/recordings/packet.h"

namespace hqslam::recordings {

/// Takes IP packets and gives their UDP datagrams back, without a time, fragments of IPv4 put
/// together. Memory is bounded: of unfinished datagrams only the latest kMaxUnfinished are kept,
/// each of at most 64 kB. The number by which fragments find each other has 16 bits: a datagram to
/// which nothing came for kMostPacketsBetween is given up before a later one has the same. Source:
/// RFC 791, RFC 768, RFC 8200 (extension headers of IPv6 are not followed).
class IpDatagrams {
 public:
  static constexpr std::size_t kMaxUnfinished = 64;
  static constexpr std::int64_t kMostPacketsBetween = 4096;

  /// Nothing for what is no UDP, is damaged, or is a fragment whose datagram is not complete. The
  /// payload lives until the next call.
  std::optional<Packet> add(Bytes ip_packet);

  std::int64_t damaged() const { return damaged_; }
  /// Datagrams of which a fragment never came.
  std::int64_t incomplete() const {
    return given_up_ + static_cast<std::int64_t>(unfinished_.size());
  }

 private:
  struct Unfinished {
    std::array<std::uint8_t, 10> key{};  ///< source, destination, identification
    std::vector<std::uint8_t> bytes;
    std::vector<bool> have;  ///< which units of eight bytes came
    std::size_t total = 0;   ///< bytes of the datagram; 0 as long as the last fragment is missing
    std::int64_t last_packet = 0;  ///< the one that brought a fragment last
  };

  std::optional<Packet> add_ipv4(Bytes packet);
  std::optional<Packet> add_ipv6(Bytes packet);
  std::optional<Packet> add_fragment(Bytes header, Bytes data);
  std::deque<Unfinished>::iterator unfinished(Bytes header);
  std::optional<Packet> udp(Bytes datagram, const Endpoint& sender);
  std::nullopt_t damaged_packet() {
    ++damaged_;
    return std::nullopt;
  }

  std::deque<Unfinished> unfinished_;
  std::vector<std::uint8_t> whole_;
  std::int64_t packets_ = 0;  ///< of any kind
  std::int64_t damaged_ = 0;
  std::int64_t given_up_ = 0;
};

}  // namespace hqslam::recordings
