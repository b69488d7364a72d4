#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "hqslam/live/live.h"
#include "http_get.h"
#include "loopback.h"
#include "udp_socket.h"

// The metadata of an Ouster that is only named, asked for over HTTP.

using namespace hqslam::live;
using namespace hqslam::recordings;

namespace {

/// Listens on a port of this computer.
FileDescriptor listening_socket(std::uint16_t& port) {
  FileDescriptor listener(socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t bytes = sizeof address;
  REQUIRE(bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), bytes) == 0);
  REQUIRE(listen(listener.get(), 1) == 0);
  getsockname(listener.get(), reinterpret_cast<sockaddr*>(&address), &bytes);
  port = ntohs(address.sin_port);
  return listener;
}

/// A server that accepts this many connections, reads the request and answers with any bytes.
class OneAnswer {
 public:
  /// hold: keeps the connections open until the end.
  explicit OneAnswer(std::string answer, int connections = 1, bool hold = false)
      : listener_(listening_socket(port_)), hold_(hold) {
    thread_ = std::thread([this, connections, answer = std::move(answer)] {
      for (int i = 0; i < connections; ++i) serve(answer);
    });
  }
  ~OneAnswer() {
    shutdown(listener_.get(), SHUT_RDWR);  // the client may not have connected
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
    FileDescriptor connection(accept(listener_.get(), nullptr, nullptr));
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
    if (hold_) held_.push_back(std::move(connection));
  }

  std::uint16_t port_ = 0;
  FileDescriptor listener_;
  bool hold_ = false;
  std::vector<FileDescriptor> held_;
  std::string asked_;
  std::thread thread_;
};

std::string http_answer(const std::string& body) {
  return "HTTP/1.1 200 OK\r\nContent-Type: application/json\r\n\r\n" + body;
}

/// Of an Ouster of 16 beams that is only named, whose metadata the server gives.
LiveOptions named(const OneAnswer& server) {
  return {.sensor = "os1-16", .port = free_udp_port(), .http_port = server.port()};
}

void send_packet(const LiveOptions& options) {
  LoopbackSender(options.port).send(ouster_turn(OusterProfile::kLegacy, 1, 16)[0].payload);
}

}  // namespace

TEST_CASE("an Ouster that is only named is asked for its metadata where its packets come from") {
  OneAnswer server(http_answer(ouster_metadata_text(OusterProfile::kLegacy, 16)));
  const LiveOptions options = named(server);
  LiveSensor sensor(options);
  send_packet(options);
  REQUIRE(sensor.recognize(kPatience_s));
  server.join();
  CHECK(server.asked().starts_with("GET /api/v1/sensor/metadata HTTP/1.1\r\n"));
  CHECK(sensor.sensor().rows() == 16);
  CHECK(refused_with([&] { sensor.start(1024); }, "512", "1024"));
  sensor.start(512);
  CHECK(refused_with([&] { sensor.start(512); }, "started", "once"));
}

TEST_CASE("why an Ouster of another kind, or one that does not answer, is refused is one line") {
  const auto refused = [](const std::string& answer) {
    OneAnswer server(answer);
    const LiveOptions options = named(server);
    LiveSensor sensor(options);
    send_packet(options);
    wait_until([&] {
      CHECK_FALSE(sensor.recognize(0.05));
      return !sensor.complaint().empty();
    });
    return sensor.complaint();
  };
  CHECK(one_line_with(refused(http_answer(ouster_metadata_text(OusterProfile::kLegacy, 32))),
                      "32 beams", "os1-16"));
  CHECK(one_line_with(refused("HTTP/1.1 404 Not Found\r\n\r\n"), "status 404", ".json file"));
  CHECK(one_line_with(refused(http_answer("no json")), ".json file"));
  CHECK(one_line_with(refused("HTTP/1.1 200 OK\r\nand no end"), "no whole"));
  CHECK(one_line_with(refused("SSH-2.0-OpenSSH\r\n"), "no whole"));
  CHECK(one_line_with(refused("HTTP/1.1 \x1B[2J\r\n\r\n"), "no whole"));
  CHECK(one_line_with(refused(""), "no whole"));
  CHECK(one_line_with(refused(http_answer(std::string(3 << 20, 'x'))), "1 MiB"));
}

TEST_CASE("a stranger's large packet does not keep the Ouster from being found") {
  const std::string text = ouster_metadata_text(OusterProfile::kLegacy, 16);
  OneAnswer server(http_answer(text));
  const LiveOptions options = named(server);
  LiveSensor sensor(options);
  LoopbackSender(options.port, 2).send(Payload(4000));  // no server answers there: refused
  CHECK_FALSE(sensor.recognize(0.05));
  send_packet(options);
  REQUIRE(sensor.recognize(kPatience_s));
  CHECK(recordings::text(sensor.sender()).starts_with("127.0.0.1:"));
}

TEST_CASE("answers in chunks, and of connections that are held open, are understood") {
  const std::string body = ouster_metadata_text(OusterProfile::kLegacy, 16);
  const std::string ok = "HTTP/1.1 200 OK\r\n";
  const auto chunk = [](const std::string& part) {
    return fmt::format("{:x};a=b\r\n{}\r\n", part.size(), part);
  };
  const std::string chunked = ok + "Transfer-Encoding: chunked\r\n\r\n" + chunk(body.substr(0, 9)) +
                              chunk(body.substr(9)) + "0\r\n\r\n";
  const std::string sized = ok + fmt::format("Content-length: {}\r\n\r\n", body.size()) + body;
  for (const std::string& answer : {chunked, sized}) {
    OneAnswer server(answer, 1, true);
    CHECK(http_get(kLoopback, server.port(), "/") == body);
  }
  for (const std::string& answer :
       {chunked.substr(0, chunked.size() - 5), sized.substr(0, sized.size() - 1),
        ok + "Content-Length: 99999999999999999999\r\n\r\n" + body,
        ok + "Transfer-Encoding: chunked\r\n\r\nzz\r\n" + body}) {
    OneAnswer server(answer);
    CHECK(refused_with([&] { http_get(kLoopback, server.port(), "/"); }, "no whole"));
  }
}

TEST_CASE("a server that is not there or never answers does not hold anybody up") {
  const UdpSocket unanswering(0);
  CHECK(refused_with([&] { http_get(kLoopback, unanswering.port(), "/"); },
                     "http://127.0.0.1:", "connection"));
  std::uint16_t port = 0;
  const FileDescriptor silent = listening_socket(port);
  CHECK(refused_with([&] { http_get(kLoopback, port, "/"); }, "within 3 s"));
  const FileDescriptor slow = listening_socket(port);
  const std::jthread byte_by_byte([&] {
    const FileDescriptor connection(accept(slow.get(), nullptr, nullptr));
    while (send(connection.get(), "HTTP/1.1 200 OK\r\nA: ", 1, MSG_NOSIGNAL) == 1) {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
  });
  CHECK(refused_with([&] { http_get(kLoopback, port, "/"); }, "within 3 s"));
}
