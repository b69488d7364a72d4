#include "udp_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "hqslam/core/error.h"

namespace hqslam::live {

using namespace recordings;

namespace {

constexpr std::size_t kMaxDatagram = 65536;
/// Half a second of a large sensor's packets; the system may give less.
constexpr int kSystemBuffer_bytes = 8 << 20;

[[noreturn]] void fail_for_port(std::uint16_t port) {
  const int error = errno;
  throw Error("UDP port {} cannot be opened ({}); {}", port, std::strerror(error),
              error == EADDRINUSE ? "end the program that uses it, or name another port"
                                  : "name another port");
}

/// A socket bound to the port for IPv6 with IPv4 inside, or for IPv4 where there is no IPv6.
FileDescriptor bound_socket(std::uint16_t port) {
  FileDescriptor socket(::socket(AF_INET6, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (socket) {
    const int no = 0;
    setsockopt(socket.get(), IPPROTO_IPV6, IPV6_V6ONLY, &no, sizeof no);
    sockaddr_in6 address{};
    address.sin6_family = AF_INET6;
    address.sin6_addr = in6addr_any;
    address.sin6_port = htons(port);
    if (bind(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) {
      return socket;
    }
    if (errno != EADDRNOTAVAIL && errno != EAFNOSUPPORT) fail_for_port(port);
  }
  socket = FileDescriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  address.sin_port = htons(port);
  if (!socket || bind(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    fail_for_port(port);
  }
  return socket;
}

std::uint16_t port_of(const FileDescriptor& socket) {
  sockaddr_storage address{};
  socklen_t bytes = sizeof address;
  getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &bytes);
  return ntohs(address.ss_family == AF_INET6
                   ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                   : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

/// IPv4 stands in the last four bytes, whether the socket is IPv6 or not.
std::array<std::uint8_t, 16> address_of(const sockaddr_storage& sender) {
  std::array<std::uint8_t, 16> address{};
  if (sender.ss_family == AF_INET6) {
    const auto& ipv6 = reinterpret_cast<const sockaddr_in6&>(sender);
    std::memcpy(address.data(), &ipv6.sin6_addr, address.size());
    if (IN6_IS_ADDR_V4MAPPED(&ipv6.sin6_addr)) std::fill_n(address.begin(), 12, 0);
  } else {
    const auto& ipv4 = reinterpret_cast<const sockaddr_in&>(sender);
    std::memcpy(address.data() + 12, &ipv4.sin_addr, 4);
  }
  return address;
}

/// Time at which the system received the datagram; the present time where it gives none.
std::int64_t arrival_ns(msghdr& message) {
  timespec time{};
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS) continue;
    std::memcpy(&time, CMSG_DATA(part), sizeof time);
    return 1'000'000'000 * static_cast<std::int64_t>(time.tv_sec) + time.tv_nsec;
  }
  clock_gettime(CLOCK_REALTIME, &time);
  return 1'000'000'000 * static_cast<std::int64_t>(time.tv_sec) + time.tv_nsec;
}

}  // namespace

UdpSocket::UdpSocket(std::uint16_t port)
    : socket_(bound_socket(port)), port_(port_of(socket_)), buffer_(kMaxDatagram) {
  const int bytes = kSystemBuffer_bytes;
  if (setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0) {
    setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
  }
  const int yes = 1;
  setsockopt(socket_.get(), SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes);
}

std::optional<Packet> UdpSocket::receive(int timeout_ms) {
  pollfd waiting{socket_.get(), POLLIN, 0};
  if (poll(&waiting, 1, timeout_ms) <= 0) return std::nullopt;
  sockaddr_storage sender{};
  iovec space{buffer_.data(), buffer_.size()};
  alignas(cmsghdr) std::array<char, 128> control{};
  msghdr message{};
  message.msg_name = &sender;
  message.msg_namelen = sizeof sender;
  message.msg_iov = &space;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t bytes = recvmsg(socket_.get(), &message, MSG_DONTWAIT);
  if (bytes < 0) {
    if (errno == EAGAIN || errno == EINTR || errno == ECONNREFUSED) return std::nullopt;
    throw Error("UDP port {} cannot be read ({}); check the network", port_, std::strerror(errno));
  }
  Packet packet;
  packet.capture_time_ns = arrival_ns(message);
  packet.endpoint = {address_of(sender), port_};
  packet.payload = {buffer_.data(), static_cast<std::size_t>(bytes)};
  return packet;
}

}  // namespace hqslam::live
