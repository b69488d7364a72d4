#include "live/view_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <httplib.h>
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
#include <map>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>

#include "hqslam/core/error.h"

namespace hqslam::tools {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostRequestBytes = 8192;
constexpr std::chrono::seconds kMostSilence(3);
constexpr std::chrono::seconds kMostTime(30);

/// The open connections, each with the time of its last byte.
class Connections {
 public:
  /// One more; of too many the one that has been silent for longest ends.
  void add(int socket) {
    const std::lock_guard lock(mutex_);
    if (last_byte_.size() >= ViewServer::kMostConnections) {
      const auto silent =
          std::ranges::min_element(last_byte_, {}, [](const auto& c) { return c.second; });
      shutdown(silent->first, SHUT_RDWR);
      last_byte_.erase(silent);
    }
    last_byte_[socket] = Clock::now();
    if (ended_) shutdown(socket, SHUT_RDWR);
  }
  void touch(int socket) {
    const std::lock_guard lock(mutex_);
    if (const auto found = last_byte_.find(socket); found != last_byte_.end()) {
      found->second = Clock::now();
    }
  }
  /// Closes the socket: another one that gets its number is not taken for it.
  void close_socket(int socket) {
    const std::lock_guard lock(mutex_);
    last_byte_.erase(socket);
    shutdown(socket, SHUT_RDWR);
    close(socket);
  }
  /// All of them, and those to come.
  void end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    for (const auto& [socket, time] : last_byte_) shutdown(socket, SHUT_RDWR);
  }

 private:
  std::mutex mutex_;
  std::map<int, Clock::time_point> last_byte_;
  bool ended_ = false;
};

/// What the HTTP library reads and writes, bounded in time and bytes: its own limits are for each
/// read alone, and a client that sends a byte a second would hold a thread for hours.
class BoundedStream : public httplib::Stream {
 public:
  BoundedStream(int socket, Connections& connections)
      : socket_(socket), connections_(connections) {}

  bool is_readable() const override { return place_ < end_ || wait(POLLIN); }
  bool is_writable() const override { return wait(POLLOUT); }
  ssize_t read(char* to, std::size_t size) override {
    if (place_ == end_) {
      if (received_ >= kMostRequestBytes || !wait(POLLIN)) return -1;
      const ssize_t bytes = recv(socket_, buffer_.data(), buffer_.size(), 0);
      if (bytes <= 0) return bytes;
      connections_.touch(socket_);
      place_ = 0;
      end_ = static_cast<std::size_t>(bytes);
      received_ += end_;
    }
    const std::size_t count = std::min(size, end_ - place_);
    std::memcpy(to, buffer_.data() + place_, count);
    place_ += count;
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* from, std::size_t size) override {
    if (!wait(POLLOUT)) return -1;
    const ssize_t bytes = send(socket_, from, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (bytes > 0) connections_.touch(socket_);
    return bytes;
  }
  void get_remote_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  void get_local_ip_and_port(std::string& /*ip*/, int& /*port*/) const override {}
  socket_t socket() const override { return socket_; }

 private:
  bool wait(short event) const {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(
        std::min<Clock::duration>(kMostSilence, begun_ + kMostTime - Clock::now()));
    pollfd waiting = {socket_, event, 0};
    return left.count() > 0 && poll(&waiting, 1, static_cast<int>(left.count())) == 1;
  }

  int socket_;
  Connections& connections_;
  Clock::time_point begun_ = Clock::now();
  std::array<char, 2048> buffer_{};
  std::size_t place_ = 0;
  std::size_t end_ = 0;
  std::size_t received_ = 0;
};

bool is_same_name(std::string_view a, std::string_view b) {
  return a.size() == b.size() && strncasecmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace

bool is_own_host(const std::string& host) {
  const std::string name = host.substr(0, host.find(':'));
  in_addr any{};
  if (host.starts_with('[') || inet_pton(AF_INET, name.c_str(), &any) == 1) return true;
  std::array<char, 256> own{};
  gethostname(own.data(), own.size() - 1);
  const std::string own_name = own.data();
  return is_same_name(name, "localhost") ||
         (!own_name.empty() &&
          (is_same_name(name, own_name) || is_same_name(name, own_name + ".local")));
}

struct ViewServer::Implementation : httplib::Server {
  Implementation(std::string served_at, std::uint16_t wanted_port, Answer answers)
      : address(std::move(served_at)), answer(std::move(answers)) {
    // The library's own options would let another program take the same port.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    // More threads than connections: one that was ended takes a moment to go.
    new_task_queue = [] { return new httplib::ThreadPool(kMostConnections + 8); };
    set_default_headers({{"Cache-Control", "no-store"},
                         {"Cross-Origin-Resource-Policy", "same-origin"},
                         {"X-Content-Type-Options", "nosniff"}});
    set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      respond(request, response);
      return HandlerResponse::Handled;
    });
    if (in_addr any{}; inet_pton(AF_INET, address.c_str(), &any) != 1) {
      throw Error("{}: is no address to show the page at, expected one of IPv4 such as 127.0.0.1",
                  address);
    }
    port = wanted_port == 0                     ? bind_to_any_port(address)
           : bind_to_port(address, wanted_port) ? wanted_port
                                                : -1;
    if (port < 0) {
      throw Error("the page cannot be served at {}:{} ({}); give --view another port", address,
                  wanted_port, std::strerror(errno));
    }
    listener = std::thread([this] { listen_after_bind(); });
    while (!is_running()) std::this_thread::yield();  // before that stop() does nothing
  }
  ~Implementation() override {
    connections.end();
    stop();
    listener.join();
  }

  void respond(const httplib::Request& request, httplib::Response& response) const {
    ViewAnswer given;
    if (request.method != "GET") {
      given = {400, given.type, "GET alone\n"};
    } else if (!is_own_host(request.get_header_value("Host")) || !request.has_header("Host")) {
      given = {403, given.type,
               "asked for by a name that is not this computer's; use its address\n"};
    } else {
      given = answer(request.target);
    }
    response.status = given.status;
    if (given.body.empty()) return;
    // A provider, because the library would compress a body, and the processor is for SLAM.
    const auto body = std::make_shared<std::string>(std::move(given.body));
    response.set_content_provider(
        body->size(), given.type,
        [body](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
          return sink.write(body->data() + offset, length);
        });
  }

  bool process_and_close_socket(socket_t socket) override {
    // The thread that computes poses does not wait for one that serves the page.
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 10);
    connections.add(socket);
    BoundedStream stream(socket, connections);
    bool is_closed = false;
    const bool is_done = process_request(stream, /*close_connection=*/true, is_closed, nullptr);
    connections.close_socket(socket);
    return is_done;
  }

  std::string address;
  Answer answer;
  int port = 0;
  Connections connections;
  std::thread listener;
};

ViewServer::ViewServer(const std::string& address, std::uint16_t port, Answer answer)
    : implementation_(std::make_unique<Implementation>(address, port, std::move(answer))) {}

ViewServer::~ViewServer() = default;

std::string ViewServer::url() const {
  return fmt::format("http://{}:{}/", implementation_->address, implementation_->port);
}

}  // namespace hqslam::tools
