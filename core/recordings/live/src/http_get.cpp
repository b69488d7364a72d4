#include "http_get.h"

#include <fmt/format.h>
#include <httplib.h>
#include <signal.h>

#include <chrono>
#include <future>

#include "hqslam/core/error.h"
#include "hqslam/recordings/packet.h"

namespace hqslam::live {

using namespace recordings;

namespace {

constexpr std::size_t kMaxAnswer_bytes = 1U << 20U;
constexpr std::chrono::seconds kMostTime(3);

/// One GET in a thread of its own, in which a connection that the server closes raises no SIGPIPE.
std::future<httplib::Result> asked(httplib::Client& client, const std::string& path,
                                   std::string& body) {
  return std::async(std::launch::async, [&] {
    sigset_t pipe;
    sigemptyset(&pipe);
    sigaddset(&pipe, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe, nullptr);
    return client.Get(path, [&](const char* part, std::size_t bytes) {
      body.append(part, bytes);
      return body.size() <= kMaxAnswer_bytes;
    });
  });
}

}  // namespace

std::string http_get(const std::array<std::uint8_t, 16>& address, std::uint16_t port,
                     const std::string& path) {
  const std::string endpoint = text(Endpoint{address, port});
  std::string host = endpoint.substr(0, endpoint.rfind(':'));
  if (host.starts_with('[')) host = host.substr(1, host.size() - 2);
  httplib::Client client(host, port);
  client.set_connection_timeout(kMostTime);
  client.set_read_timeout(kMostTime);
  client.set_decompress(false);
  std::string body;
  const auto begin = std::chrono::steady_clock::now();
  std::future<httplib::Result> answer = asked(client, path, body);
  // The library limits each read alone: a server that sends a byte a second would take hours.
  std::chrono::milliseconds wait = kMostTime;
  while (answer.wait_for(wait) == std::future_status::timeout) {
    client.stop();
    wait = std::chrono::milliseconds(50);
  }
  const httplib::Result result = answer.get();
  if (result && result->status == 200) return body;
  // Whichever of the two limits came first.
  const bool is_late = std::chrono::steady_clock::now() - begin >= kMostTime;
  throw Error("http://{}{}: expected an answer, found {}", endpoint, path,
              is_late                          ? "none within 3 s"
              : body.size() > kMaxAnswer_bytes ? "more than 1 MiB"
              : result                         ? fmt::format("status {}", result->status)
              : result.error() == httplib::Error::Connection ? "no connection"
                                                             : "no whole HTTP response");
}

}  // namespace hqslam::live
