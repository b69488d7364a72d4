#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "byte_reader.h"
#include "hqslam/recordings/packet.h"

namespace hqslam::recordings {

/// IP packets -> UDP datagrams, without a time; fragments of IPv4 are put together. Memory is
/// bounded: of unfinished datagrams only the latest kMaxUnfinished are kept, each of at most 64 kB.
/// Fragments are matched by a number of 16 bits: a datagram that received none for
/// kMostPacketsBetween packets is given up before a later one has the same number. Source:
/// RFC 791, RFC 768, RFC 8200 (extension headers of IPv6 are not followed).
class IpDatagrams {
 public:
  static constexpr std::size_t kMaxUnfinished = 64;
  static constexpr std::int64_t kMostPacketsBetween = 4096;

  /// Nothing for other packets than UDP, damaged ones, and fragments whose datagram is not
  /// complete. The payload lives until the next call.
  std::optional<Packet> add(Bytes ip_packet);

  std::int64_t damaged() const { return damaged_; }
  /// Number of datagrams with a missing fragment.
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
