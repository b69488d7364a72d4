#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hqslam/core/file_descriptor.h"
#include "hqslam/recordings/packet.h"

namespace hqslam::live {

/// Receives the UDP datagrams of all senders to a port, by IPv4 and IPv6.
class UdpSocket {
 public:
  /// port 0: any free one. Throws Error if the port cannot be opened.
  explicit UdpSocket(std::uint16_t port);

  std::uint16_t port() const { return port_; }
  /// The next datagram, or nothing within that time. Its time is that of its arrival at the system;
  /// its payload lives until the next call. Throws Error if the socket fails.
  std::optional<recordings::Packet> receive(int timeout_ms);

 private:
  FileDescriptor socket_;
  std::uint16_t port_ = 0;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace hqslam::live
