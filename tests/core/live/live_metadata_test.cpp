#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <thread>

#include "core/recordings/captures.h"
#include "error_message.h"
#include "hqslam/core/file_descriptor.h"
#include "hqslam/live/live.h"
#include "http_get.h"
#include "loopback.h"
#include "udp_socket.h"

// The metadata of an Ouster that is only named, asked for over HTTP.

using namespace hqslam;
using namespace hqslam::live;
using namespace hqslam::recordings;
using namespace hqslam::test;

namespace {

constexpr double kPatience_s = 20.0;

/// A server that takes so many connections, reads what is asked and gives back any bytes.
class OneAnswer {
 public:
  explicit OneAnswer(std::string answer, int connections = 1)
      : listener_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t bytes = sizeof address;
    bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), bytes);
    listen(listener_.get(), 1);
    getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &bytes);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this, connections, answer = std::move(answer)] {
      for (int i = 0; i < connections; ++i) serve(answer);
    });
  }
  ~OneAnswer() {
    shutdown(listener_.get(), SHUT_RDWR);  // whoever was to connect may not have come
    join();
  }
  void join() {
    if (thread_.joinable()) thread_.join();
  }
  std::uint16_t port() const { return port_; }
  /// Once it has answered.
  const std::string& asked() const { return asked_; }

 private:
  void serve(const std::string& answer) {
    const FileDescriptor connection(accept(listener_.get(), nullptr, nullptr));
    char buffer[1024];
    const ssize_t read = recv(connection.get(), buffer, sizeof buffer, 0);
    asked_.assign(buffer, static_cast<std::size_t>(std::max<ssize_t>(read, 0)));
    std::size_t sent = 0;
    while (sent < answer.size()) {
      const ssize_t part =
          send(connection.get(), answer.data() + sent, answer.size() - sent, MSG_NOSIGNAL);
      if (part <= 0) break;
      sent += static_cast<std::size_t>(part);
    }
  }

  FileDescriptor listener_;
  std::uint16_t port_ = 0;
  std::string asked_;
  std::thread thread_;
};

constexpr std::array<std::uint8_t, 16> kLoopback = {0, 0, 0, 0, 0,   0, 0, 0,
                                                    0, 0, 0, 0, 127, 0, 0, 1};

std::string http_answer(const std::string& body) {
  return "HTTP/1.1 200 OK\r\nContent-Type: application/json\r\n\r\n" + body;
}

}  // namespace

TEST_CASE("an Ouster that is only named is asked for its metadata where its packets come from") {
  std::string text = ouster_metadata_text(OusterProfile::kLegacy, 16);
  OneAnswer server(http_answer(text));
  LiveOptions options;
  options.sensor = "os1-16";
  options.port = free_udp_port();
  options.http_port = server.port();
  LiveSensor sensor(options);
  const LoopbackSender sender(options.port);
  sender.send(ouster_turn(OusterProfile::kLegacy, 1, 16)[0].payload);
  REQUIRE(sensor.recognise(kPatience_s));
  server.join();
  CHECK(server.asked().starts_with("GET /api/v1/sensor/metadata HTTP/1.0\r\n"));
  CHECK(sensor.sensor().rows() == 16);
  CHECK(one_line_with(error_message([&] { sensor.start(1024); }), "512", "1024"));
  sensor.start(512);
  CHECK(one_line_with(error_message([&] { sensor.start(512); }), "started", "once"));
}

TEST_CASE("an Ouster of another kind is refused as often as it is asked for") {
  OneAnswer server(http_answer(ouster_metadata_text(OusterProfile::kLegacy, 32)), 2);
  LiveOptions options;
  options.sensor = "os1-16";
  options.port = free_udp_port();
  options.http_port = server.port();
  LiveSensor sensor(options);
  for (int attempt = 0; attempt < 2; ++attempt) {
    LoopbackSender(options.port).send(ouster_turn(OusterProfile::kLegacy, 1, 32)[0].payload);
    CHECK(one_line_with(error_message([&] { sensor.recognise(1e300); }), "32 beams", "os1-16"));
  }
}

TEST_CASE("an Ouster of another kind, or one that says nothing, is refused in one line") {
  const auto refused = [](const std::string& answer) {
    OneAnswer server(answer);
    LiveOptions options;
    options.sensor = "os1-16";
    options.port = free_udp_port();
    options.http_port = server.port();
    LiveSensor sensor(options);
    LoopbackSender(options.port).send(ouster_turn(OusterProfile::kLegacy, 1, 16)[0].payload);
    return error_message([&] { sensor.recognise(kPatience_s); });
  };
  CHECK(one_line_with(refused(http_answer(ouster_metadata_text(OusterProfile::kLegacy, 32))),
                      "32 beams", "os1-16"));
  CHECK(one_line_with(refused("HTTP/1.1 404 Not Found\r\n\r\n"), "status 404", ".json file"));
  CHECK(one_line_with(refused(http_answer("no json")), ".json file"));
  CHECK(one_line_with(refused("HTTP/1.1 200 OK\r\nand no end"), "cut off"));
  CHECK(one_line_with(refused("SSH-2.0-OpenSSH\r\n"), "no HTTP"));
  CHECK(one_line_with(refused("HTTP/1.1 \x1B[2J\r\n\r\n"), "no HTTP"));
  CHECK(one_line_with(refused(""), "no HTTP"));
  CHECK(one_line_with(refused(http_answer(std::string(3 << 20, 'x'))), "1 MiB"));
}

TEST_CASE("a server that is not there or never answers does not hold anybody up") {
  const UdpSocket nobody(0);
  CHECK(one_line_with(error_message([&] { http_get(kLoopback, nobody.port(), "/"); }),
                      "http://127.0.0.1:", "refused"));
  const FileDescriptor silent(socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t bytes = sizeof address;
  REQUIRE(bind(silent.get(), reinterpret_cast<const sockaddr*>(&address), bytes) == 0);
  REQUIRE(listen(silent.get(), 1) == 0);
  getsockname(silent.get(), reinterpret_cast<sockaddr*>(&address), &bytes);
  CHECK(one_line_with(error_message([&] { http_get(kLoopback, ntohs(address.sin_port), "/"); }),
                      "within 3 s"));
}
