#pragma once

#include <cstdint>
#include <vector>

#include "core/recordings/captures.h"
#include "hqslam/core/file_descriptor.h"

namespace hqslam::test {

/// Sends datagrams to a UDP port of this computer, as a sensor would.
class LoopbackSender {
 public:
  explicit LoopbackSender(std::uint16_t port);
  void send(const Payload& payload) const;

 private:
  FileDescriptor socket_;
};

/// A UDP port that nobody listens to just now.
std::uint16_t free_udp_port();

/// Sends packets so much faster than they were captured; 0: as fast as it goes, with a pause every
/// 16 packets, because the system's buffer is finite.
void replay(const std::vector<Captured>& packets, std::uint16_t port, double speed);

}  // namespace hqslam::test
