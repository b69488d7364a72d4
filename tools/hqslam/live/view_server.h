#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "hqslam/core/file_descriptor.h"

namespace hqslam::tools {

/// What a browser is answered.
struct ViewAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
};

/// Whether a request's Host names this computer: its addresses and own names. A page of another
/// site whose name was made to lead here (DNS rebinding) asks with that name, and would read the
/// map.
bool is_own_host(const std::string& host);

/// Serves a page to browsers: GET alone, each request in a connection of its own, up to
/// kMostConnections side by side; where there are more, the one that has said nothing for longest
/// goes. One thread for all, which leaves the processor to whoever wants it.
class ViewServer {
 public:
  static constexpr std::size_t kMostConnections = 32;

  /// Answers the request for a target such as "/state?points=3"; called by the server's thread.
  using Answer = std::function<ViewAnswer(const std::string& target)>;

  /// address: IPv4, "127.0.0.1" for this computer alone. port 0: any free one. Throws Error.
  ViewServer(const std::string& address, std::uint16_t port, Answer answer);
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  /// "http://127.0.0.1:8642/"
  std::string url() const;

 private:
  struct Connection;
  void run();
  void accept_all(std::vector<Connection>& connections) const;
  /// Reads or sends as much as can be now. Returns whether there is more to come.
  bool proceed(Connection& connection) const;
  std::string response_to(const std::string& request) const;

  std::string address_;
  std::uint16_t port_ = 0;
  Answer answer_;
  FileDescriptor listener_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace hqslam::tools
