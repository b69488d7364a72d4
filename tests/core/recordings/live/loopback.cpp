#include "loopback.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "udp_socket.h"

namespace hqslam::test {

LoopbackSender::LoopbackSender(std::uint16_t port, std::uint8_t host)
    : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
  sockaddr_in from{};
  from.sin_family = AF_INET;
  from.sin_addr.s_addr = htonl(INADDR_LOOPBACK - 1 + host);
  if (bind(socket_.get(), reinterpret_cast<const sockaddr*>(&from), sizeof from) != 0) {
    throw std::runtime_error("no address 127.0.0." + std::to_string(host));
  }
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = htons(port);
  if (connect(socket_.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
    throw std::runtime_error("no loopback address");
  }
}

/// Whether anybody receives it is not the sender's concern.
void LoopbackSender::send(const Payload& payload) const {
  ::send(socket_.get(), payload.data(), payload.size(), MSG_NOSIGNAL);
}

std::uint16_t free_udp_port() { return live::UdpSocket(0).port(); }

void replay(const std::vector<Captured>& packets, std::uint16_t port, double speed,
            std::uint8_t host) {
  const LoopbackSender sender(port, host);
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < packets.size(); ++i) {
    if (speed > 0.0) {
      const double passed_ns = static_cast<double>(packets[i].time_ns - packets[0].time_ns);
      std::this_thread::sleep_until(
          start + std::chrono::nanoseconds(static_cast<std::int64_t>(passed_ns / speed)));
    } else if (i % 16 == 15) {
      std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
    sender.send(packets[i].payload);
  }
}

}  // namespace hqslam::test
