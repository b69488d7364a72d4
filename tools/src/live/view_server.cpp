#include "live/view_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

#include "hqslam/core/error.h"

namespace hqslam::tools {
namespace {

constexpr std::size_t kMostRequestBytes = 8192;
constexpr int kWaiting = 8;
constexpr int kPoll_ms = 100;
constexpr std::chrono::seconds kMostTime(2);

using Clock = std::chrono::steady_clock;

/// Waits until the connection is ready for `event`; false if the time is over.
bool wait_for(const FileDescriptor& connection, short event, Clock::time_point end) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
  pollfd waiting{connection.get(), event, 0};
  return left.count() > 0 && poll(&waiting, 1, static_cast<int>(left.count())) > 0;
}

/// Up to the empty line that ends it; empty if it does not come, or never ends.
std::string request_from(const FileDescriptor& connection, Clock::time_point end) {
  std::string request;
  std::array<char, 1024> part{};
  while (request.find("\r\n\r\n") == std::string::npos) {
    if (request.size() > kMostRequestBytes || !wait_for(connection, POLLIN, end)) return "";
    const ssize_t bytes = recv(connection.get(), part.data(), part.size(), MSG_DONTWAIT);
    if (bytes <= 0) return "";
    request.append(part.data(), static_cast<std::size_t>(bytes));
  }
  return request;
}

void send_all(const FileDescriptor& connection, const std::string& text, Clock::time_point end) {
  std::size_t sent = 0;
  while (sent < text.size() && wait_for(connection, POLLOUT, end)) {
    const ssize_t bytes =
        send(connection.get(), text.data() + sent, text.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (bytes <= 0) return;
    sent += static_cast<std::size_t>(bytes);
  }
}

std::string http(const ViewAnswer& answer) {
  const char* const reason = answer.status == 200   ? "OK"
                             : answer.status == 404 ? "Not Found"
                                                    : "Bad Request";
  return fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
      "Connection: close\r\n\r\n{}",
      answer.status, reason, answer.type, answer.body.size(), answer.body);
}

}  // namespace

ViewServer::ViewServer(const std::string& address, std::uint16_t port, Answer answer)
    : address_(address), answer_(std::move(answer)) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &to.sin_addr) != 1) {
    throw Error(fmt::format(
        "{}: is no address to show the page at, expected one of IPv4 such as 127.0.0.1", address));
  }
  listener_ = FileDescriptor(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  setsockopt(listener_.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  socklen_t bytes = sizeof to;
  if (bind(listener_.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0 ||
      listen(listener_.get(), kWaiting) != 0 ||
      getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&to), &bytes) != 0) {
    throw Error(fmt::format("the page cannot be served at {}:{} ({}); give --view another port",
                            address, port, std::strerror(errno)));
  }
  port_ = ntohs(to.sin_port);
  thread_ = std::thread([this] { run(); });
}

ViewServer::~ViewServer() {
  stop_ = true;
  thread_.join();
}

std::string ViewServer::url() const { return fmt::format("http://{}:{}/", address_, port_); }

void ViewServer::run() {
  while (!stop_) {
    pollfd waiting{listener_.get(), POLLIN, 0};
    if (poll(&waiting, 1, kPoll_ms) <= 0) continue;
    const FileDescriptor connection(accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (connection) serve(connection);
  }
}

void ViewServer::serve(const FileDescriptor& connection) const {
  const Clock::time_point end = Clock::now() + kMostTime;
  const std::string request = request_from(connection, end);
  const std::size_t target_end = request.find(' ', 4);
  const bool is_get = request.starts_with("GET /") && target_end < request.find("\r\n");
  const ViewAnswer answer =
      is_get ? answer_(request.substr(4, target_end - 4)) : ViewAnswer{400, {}, "GET alone\n"};
  send_all(connection, http(answer), end);
}

}  // namespace hqslam::tools
