#include "packets/ip_datagram.h"

#include <fmt/format.h>

#include <algorithm>

namespace hqslam::recordings {

namespace {

constexpr std::uint8_t kUdp = 17;
constexpr std::size_t kUdpHeader = 8;
constexpr std::size_t kIpv6Header = 40;
constexpr std::size_t kMaxDatagram = 65535;
constexpr std::size_t kUnit = 8;  // fragments are cut at multiples of it, bytes

Endpoint ipv4_sender(Bytes header) {
  Endpoint sender;
  std::copy_n(header.data() + 12, 4, sender.address.begin() + 12);
  return sender;
}

}  // namespace

bool is_ipv4(const std::array<std::uint8_t, 16>& address) {
  return std::all_of(address.begin(), address.begin() + 12, [](auto byte) { return byte == 0; });
}

std::string text(const Endpoint& endpoint) {
  const auto& a = endpoint.address;
  if (is_ipv4(endpoint.address)) {
    return fmt::format("{}.{}.{}.{}:{}", a[12], a[13], a[14], a[15], endpoint.port);
  }
  std::string groups;
  for (std::size_t i = 0; i < a.size(); i += 2) {
    groups += fmt::format("{}{:x}", i == 0 ? "" : ":", a[i] << 8 | a[i + 1]);
  }
  return fmt::format("[{}]:{}", groups, endpoint.port);
}

std::optional<Packet> IpDatagrams::add(Bytes ip_packet) {
  if (ip_packet.empty()) return std::nullopt;
  ++packets_;
  switch (ip_packet[0] >> 4) {
    case 4:
      return add_ipv4(ip_packet);
    case 6:
      return add_ipv6(ip_packet);
    default:
      return std::nullopt;
  }
}

std::optional<Packet> IpDatagrams::add_ipv4(Bytes packet) {
  const std::size_t header_bytes = 4 * static_cast<std::size_t>(packet[0] & 0x0F);
  if (header_bytes < 20 || packet.size() < header_bytes) return damaged_packet();
  if (packet[9] != kUdp) return std::nullopt;
  const std::size_t total = big_endian_16(packet, 2);
  const bool fragment = (big_endian_16(packet, 6) & 0x3FFF) != 0;
  if (total < header_bytes || (fragment && total > packet.size()))
    return damaged_packet();  // cut off when it was recorded, or never whole
  const Bytes header = packet.first(header_bytes);
  // Old firmware of the VLP-16 gives its packets of positions the length of its packets of points:
  // the length in the UDP header decides whether anything is missing.
  const Bytes data = packet.subspan(header_bytes, std::min(total, packet.size()) - header_bytes);
  return fragment ? add_fragment(header, data) : udp(data, ipv4_sender(header));
}

std::optional<Packet> IpDatagrams::add_ipv6(Bytes packet) {
  if (packet.size() < kIpv6Header) return damaged_packet();
  if (packet[6] != kUdp) return std::nullopt;
  const std::size_t bytes = big_endian_16(packet, 4);
  if (bytes > packet.size() - kIpv6Header) return damaged_packet();
  Endpoint sender;
  std::copy_n(packet.data() + 8, sender.address.size(), sender.address.begin());
  return udp(packet.subspan(kIpv6Header, bytes), sender);
}

/// The datagram to which a fragment with this header belongs, be it a new one.
std::deque<IpDatagrams::Unfinished>::iterator IpDatagrams::unfinished(Bytes header) {
  std::array<std::uint8_t, 10> key{};
  std::copy_n(header.data() + 12, 8, key.begin());
  std::copy_n(header.data() + 4, 2, key.begin() + 8);
  auto found = std::ranges::find(unfinished_, key, &Unfinished::key);
  if (found != unfinished_.end() && packets_ - found->last_packet > kMostPacketsBetween) {
    unfinished_.erase(found);
    ++given_up_;
    found = unfinished_.end();
  }
  if (found == unfinished_.end()) {
    if (unfinished_.size() == kMaxUnfinished) {
      unfinished_.pop_front();
      ++given_up_;
    }
    found = unfinished_.emplace(unfinished_.end());
    found->key = key;
  }
  found->last_packet = packets_;
  return found;
}

std::optional<Packet> IpDatagrams::add_fragment(Bytes header, Bytes data) {
  const std::size_t first = kUnit * (big_endian_16(header, 6) & 0x1FFF);
  const bool more = (header[6] & 0x20) != 0;
  if (data.empty() || first + data.size() > kMaxDatagram || (more && data.size() % kUnit != 0))
    return damaged_packet();
  const auto found = unfinished(header);
  if (found->bytes.size() < first + data.size()) {
    found->bytes.resize(first + data.size());
    found->have.resize((first + data.size() + kUnit - 1) / kUnit, false);
  }
  std::ranges::copy(data, found->bytes.begin() + static_cast<std::ptrdiff_t>(first));
  for (std::size_t at = first; at < first + data.size(); at += kUnit)
    found->have[at / kUnit] = true;
  if (!more) found->total = first + data.size();
  const bool complete = found->total > 0 && found->bytes.size() == found->total &&
                        std::ranges::find(found->have, false) == found->have.end();
  if (!complete) return std::nullopt;
  whole_ = std::move(found->bytes);
  unfinished_.erase(found);
  return udp(whole_, ipv4_sender(header));
}

std::optional<Packet> IpDatagrams::udp(Bytes datagram, const Endpoint& sender) {
  if (datagram.size() < kUdpHeader) return damaged_packet();
  const std::size_t bytes = big_endian_16(datagram, 4);
  if (bytes < kUdpHeader || bytes > datagram.size()) return damaged_packet();
  Packet result;
  result.endpoint = sender;
  result.endpoint.port = big_endian_16(datagram, 2);
  result.payload = datagram.subspan(kUdpHeader, bytes - kUdpHeader);
  return result;
}

}  // namespace hqslam::recordings
