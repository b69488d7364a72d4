#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "hqslam/core/file_descriptor.h"

namespace hqslam::tools {

/// What a browser is answered.
struct ViewAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
};

/// Serves a page to browsers: GET alone, one request after the other, each in a connection of its
/// own and within two seconds, so that no browser can hold up more than the page.
class ViewServer {
 public:
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
  void run();
  void serve(const FileDescriptor& connection) const;

  std::string address_;
  std::uint16_t port_ = 0;
  Answer answer_;
  FileDescriptor listener_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace hqslam::tools
