#pragma once

#include "core/recordings/captures.h"
#include "hqslam/core/file_descriptor.h"

namespace hqslam::test {

/// The address of this computer, as one of IPv6.
inline constexpr std::array<std::uint8_t, 16> kLoopback = {0, 0, 0, 0, 0,   0, 0, 0,
                                                           0, 0, 0, 0, 127, 0, 0, 1};

/// Sends datagrams to a UDP port of this computer, as a sensor would.
class LoopbackSender {
 public:
  /// `host`: sends from 127.0.0.host.
  explicit LoopbackSender(std::uint16_t port, std::uint8_t host = 1);
  void send(const Payload& payload) const;

 private:
  FileDescriptor socket_;
};

/// More than what is waited for takes on any computer.
inline constexpr double kPatience_s = 20.0;
/// Waits until it is so, but no longer than that.
void wait_until(const auto& is_so) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kPatience_s);
  while (!is_so() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
}

/// A UDP port without a listener.
std::uint16_t free_udp_port();

/// Sends packets so much faster than they were captured; 0: as fast as it goes, with a pause every
/// 16 packets, because the system's buffer is finite.
void replay(const std::vector<Captured>& packets, std::uint16_t port, double speed,
            std::uint8_t host = 1);

}  // namespace hqslam::test
