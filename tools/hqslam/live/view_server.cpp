#include "live/view_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "hqslam/core/error.h"

namespace hqslam::tools {
namespace {

constexpr std::size_t kMostRequestBytes = 8192;
constexpr int kWaiting = 64;
constexpr int kPoll_ms = 100;
/// So long a connection may stay without a byte, and so long in all.
constexpr std::chrono::seconds kMostSilence(3);
constexpr std::chrono::seconds kMostTime(30);

using Clock = std::chrono::steady_clock;

/// The value of a header field, its name in lower case; nothing if it is not there.
std::optional<std::string> header_field(const std::string& request, std::string_view name) {
  std::size_t line = request.find("\r\n");
  while (line != std::string::npos && line + 2 < request.size()) {
    const std::size_t begin = line + 2;
    line = request.find("\r\n", begin);
    const std::string text = request.substr(begin, line - begin);
    const std::size_t colon = text.find(':');
    if (colon != name.size() || strncasecmp(text.c_str(), name.data(), colon) != 0) continue;
    const std::size_t value = text.find_first_not_of(" \t", colon + 1);
    const std::size_t end = text.find_last_not_of(" \t");
    return value == std::string::npos ? "" : text.substr(value, end - value + 1);
  }
  return std::nullopt;
}

std::string http(const ViewAnswer& answer) {
  const char* const reason = answer.status == 200   ? "OK"
                             : answer.status == 403 ? "Forbidden"
                             : answer.status == 404 ? "Not Found"
                                                    : "Bad Request";
  return fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
      "Cross-Origin-Resource-Policy: same-origin\r\nX-Content-Type-Options: nosniff\r\n"
      "Connection: close\r\n\r\n{}",
      answer.status, reason, answer.type, answer.body.size(), answer.body);
}

}  // namespace

bool is_own_host(const std::string& host) {
  const std::string name = host.substr(0, host.find(':'));
  in_addr any{};
  if (host.starts_with('[') || inet_pton(AF_INET, name.c_str(), &any) == 1) return true;
  std::array<char, 256> own{};
  gethostname(own.data(), own.size() - 1);
  const std::string own_name = own.data();
  const auto is_called = [&](const std::string& other) {
    return name.size() == other.size() && strncasecmp(name.data(), other.data(), name.size()) == 0;
  };
  return is_called("localhost") ||
         (!own_name.empty() && (is_called(own_name) || is_called(own_name + ".local")));
}

ViewServer::ViewServer(const std::string& address, std::uint16_t port, Answer answer)
    : address_(address), answer_(std::move(answer)) {
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &to.sin_addr) != 1) {
    throw Error("{}: is no address to show the page at, expected one of IPv4 such as 127.0.0.1",
                address);
  }
  listener_ = FileDescriptor(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  setsockopt(listener_.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  socklen_t bytes = sizeof to;
  if (bind(listener_.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0 ||
      listen(listener_.get(), kWaiting) != 0 ||
      getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&to), &bytes) != 0) {
    throw Error("the page cannot be served at {}:{} ({}); give --view another port", address, port,
                std::strerror(errno));
  }
  port_ = ntohs(to.sin_port);
  thread_ = std::thread([this] { run(); });
}

ViewServer::~ViewServer() {
  stop_ = true;
  thread_.join();
}

std::string ViewServer::url() const { return fmt::format("http://{}:{}/", address_, port_); }

/// A browser's request on its way in, then the answer on its way out.
struct ViewServer::Connection {
  FileDescriptor socket;
  Clock::time_point begun = Clock::now();
  Clock::time_point last_byte = begun;
  std::string request = {};
  std::string response = {};  ///< empty: the request is not whole yet
  std::size_t sent = 0;

  /// Judged only where no byte can be read or sent: the thread itself may have had to wait.
  bool is_over() const {
    const Clock::time_point now = Clock::now();
    return now - last_byte > kMostSilence || now - begun > kMostTime;
  }
};

void ViewServer::run() {
  // Nobody may wait for a pose because somebody looks at the page.
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10);
  std::vector<Connection> connections;
  while (!stop_) {
    std::vector<pollfd> waiting = {{listener_.get(), POLLIN, 0}};
    for (const Connection& connection : connections) {
      const auto event = static_cast<short>(connection.response.empty() ? POLLIN : POLLOUT);
      waiting.push_back({connection.socket.get(), event, 0});
    }
    if (poll(waiting.data(), waiting.size(), kPoll_ms) < 0) continue;
    for (std::size_t i = connections.size(); i-- > 0;) {
      const bool can_proceed = waiting[i + 1].revents != 0;
      if (can_proceed ? !proceed(connections[i]) : connections[i].is_over()) {
        connections.erase(connections.begin() + static_cast<std::ptrdiff_t>(i));
      }
    }
    if (waiting.front().revents != 0) accept_all(connections);
  }
}

void ViewServer::accept_all(std::vector<Connection>& connections) const {
  while (true) {
    FileDescriptor socket(accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!socket) return;
    if (connections.size() == kMostConnections) {
      connections.erase(std::ranges::min_element(connections, {}, &Connection::last_byte));
    }
    connections.push_back(Connection{std::move(socket)});
  }
}

bool ViewServer::proceed(Connection& connection) const {
  if (connection.response.empty()) {
    std::array<char, 1024> part{};
    const ssize_t bytes = recv(connection.socket.get(), part.data(), part.size(), 0);
    if (bytes <= 0) return bytes < 0 && errno == EAGAIN;
    connection.request.append(part.data(), static_cast<std::size_t>(bytes));
    connection.last_byte = Clock::now();
    if (connection.request.find("\r\n\r\n") != std::string::npos) {
      connection.response = response_to(connection.request);
    }
    return connection.request.size() <= kMostRequestBytes;
  }
  const std::string& text = connection.response;
  const ssize_t bytes = send(connection.socket.get(), text.data() + connection.sent,
                             text.size() - connection.sent, MSG_NOSIGNAL);
  if (bytes < 0) return errno == EAGAIN;
  connection.sent += static_cast<std::size_t>(bytes);
  connection.last_byte = Clock::now();
  return connection.sent < text.size();
}

std::string ViewServer::response_to(const std::string& request) const {
  const std::size_t target_end = request.find(' ', 4);
  if (!request.starts_with("GET /") || target_end >= request.find("\r\n")) {
    return http({400, {}, "GET alone\n"});
  }
  const std::optional<std::string> host = header_field(request, "host");
  if (!host || !is_own_host(*host)) {
    return http({403, {}, "asked for by a name that is not this computer's; use its address\n"});
  }
  return http(answer_(request.substr(4, target_end - 4)));
}

}  // namespace hqslam::tools
