#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace hqslam::tools {

/// The answer to a browser's request.
struct ViewAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
};

/// Whether a request's Host names this computer: one of its addresses or own names. A page of
/// another site whose name was made to lead here (DNS rebinding) asks with that name, and would
/// read the map.
bool is_own_host(const std::string& host);

/// Serves a page to browsers: GET alone, one request per connection, up to kMostConnections side by
/// side; one more ends the one that has been silent for longest. A connection has 3 s without a
/// byte, 30 s and 8,192 bytes of request in all. Its threads give way to all others. No file can be
/// asked for: every answer is `answer`'s.
class ViewServer {
 public:
  static constexpr std::size_t kMostConnections = 32;

  /// Answers the request for a target such as "/state"; called by several threads at once.
  using Answer = std::function<ViewAnswer(const std::string& target)>;

  /// address: IPv4, "127.0.0.1" for this computer alone. port 0: any free one. Throws Error.
  ViewServer(const std::string& address, std::uint16_t port, Answer answer);
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  /// "http://127.0.0.1:8642/"
  std::string url() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::tools
