#include "http_get.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <optional>
#include <string_view>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/core/file_descriptor.h"
#include "hqslam/recordings/packet.h"

namespace hqslam::live {

using namespace recordings;

namespace {

constexpr std::size_t kMaxAnswer_bytes = 1U << 20U;
constexpr std::size_t kPart_bytes = 65536;
constexpr std::chrono::seconds kMostTime(3);
constexpr std::string_view kLineEnd = "\r\n";
constexpr std::string_view kHeadersEnd = "\r\n\r\n";

/// One exchange with a server that may be slow or hostile.
class Exchange {
 public:
  Exchange(const std::array<std::uint8_t, 16>& address, std::uint16_t port, const std::string& path)
      : url_(fmt::format("http://{}{}", text(Endpoint{address, port}), path)) {
    connect(address, port);
  }

  void send(const std::string& request) {
    std::size_t sent = 0;
    while (sent < request.size()) {
      wait_for(POLLOUT);
      const ssize_t bytes =
          ::send(socket_.get(), request.data() + sent, request.size() - sent, MSG_NOSIGNAL);
      if (bytes < 0 && errno != EAGAIN && errno != EINTR) fail(std::strerror(errno));
      sent += bytes > 0 ? static_cast<std::size_t>(bytes) : 0;
    }
  }

  /// Reads on until whole(answer) says that nothing more is wanted, or the server closes
  /// the connection.
  template <typename Whole>
  std::string answer(const Whole& whole) {
    std::string answer;
    std::vector<char> part(kPart_bytes);
    while (!whole(answer)) {
      wait_for(POLLIN);
      const ssize_t bytes = recv(socket_.get(), part.data(), part.size(), 0);
      if (bytes == 0) return answer;
      if (bytes < 0 && errno != EAGAIN && errno != EINTR) fail(std::strerror(errno));
      if (bytes > 0) answer.append(part.data(), static_cast<std::size_t>(bytes));
      if (answer.size() > kMaxAnswer_bytes) fail("more than 1 MiB");
    }
    return answer;
  }

  [[noreturn]] void fail(const std::string& found) const {
    throw Error("{}: expected an answer, found {}", url_, found);
  }

 private:
  void connect(const std::array<std::uint8_t, 16>& address, std::uint16_t port) {
    const bool ipv4 = is_ipv4(address);
    socket_ = FileDescriptor(
        socket(ipv4 ? AF_INET : AF_INET6, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (!socket_) fail(std::strerror(errno));
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    std::memcpy(&to.sin_addr, address.data() + 12, 4);
    sockaddr_in6 to_ipv6{};
    to_ipv6.sin6_family = AF_INET6;
    to_ipv6.sin6_port = htons(port);
    std::memcpy(&to_ipv6.sin6_addr, address.data(), address.size());
    const int done =
        ipv4
            ? ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to)
            : ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&to_ipv6), sizeof to_ipv6);
    if (done == 0) return;
    if (errno != EINPROGRESS) fail(std::strerror(errno));
    wait_for(POLLOUT);
    int error = 0;
    socklen_t bytes = sizeof error;
    getsockopt(socket_.get(), SOL_SOCKET, SO_ERROR, &error, &bytes);
    if (error != 0) fail(std::strerror(error));
  }

  void wait_for(short event) const {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end_ - std::chrono::steady_clock::now());
    pollfd waiting{socket_.get(), event, 0};
    if (left.count() <= 0 || poll(&waiting, 1, static_cast<int>(left.count())) == 0) {
      fail("none within 3 s");
    }
  }

  std::string url_;
  std::chrono::steady_clock::time_point end_ = std::chrono::steady_clock::now() + kMostTime;
  FileDescriptor socket_;
};

/// What stands behind "name:" in the headers, in small letters; nothing if it is not there.
std::optional<std::string> header(std::string_view answer, const std::string& name) {
  std::string headers(answer.substr(0, answer.find(kHeadersEnd) + kLineEnd.size()));
  for (char& c : headers) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::size_t at = headers.find(fmt::format("{}{}:", kLineEnd, name));
  if (at == std::string::npos) return std::nullopt;
  const std::size_t begin = headers.find_first_not_of(' ', at + kLineEnd.size() + name.size() + 1);
  return headers.substr(begin, headers.find(kLineEnd, begin) - begin);
}

/// A number of bytes to the base; nothing for what is none or more than an answer may have.
std::optional<std::size_t> size_from(std::string_view text, int base) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc() || end == text.data() || value > kMaxAnswer_bytes) return std::nullopt;
  return value;
}

/// The chunks of a body put together; nothing as long as the last one, of no bytes, is missing.
/// Source: RFC 9112, 7.1.
std::optional<std::string> joined_chunks(std::string_view body) {
  std::string joined;
  while (true) {
    const std::size_t line = body.find(kLineEnd);
    if (line == std::string_view::npos) return std::nullopt;
    const auto size = size_from(body.substr(0, line), 16);
    body.remove_prefix(line + kLineEnd.size());
    if (!size || body.size() < *size) return std::nullopt;
    if (*size == 0) return joined;
    joined += body.substr(0, *size);
    body.remove_prefix(std::min(body.size(), *size + kLineEnd.size()));
  }
}

/// The body of an answer; nothing as long as some of it is missing. Where the answer does not say
/// how long it is, it ends with the connection.
std::optional<std::string> body_of(std::string_view answer, bool closed) {
  const std::size_t end_of_headers = answer.find(kHeadersEnd);
  if (end_of_headers == std::string_view::npos) return std::nullopt;
  const std::string_view body = answer.substr(end_of_headers + kHeadersEnd.size());
  if (const auto coding = header(answer, "transfer-encoding"); coding == "chunked") {
    return joined_chunks(body);
  }
  if (const auto length = header(answer, "content-length")) {
    const auto bytes = size_from(*length, 10);
    if (!bytes || body.size() < *bytes) return std::nullopt;
    return std::string(body.substr(0, *bytes));
  }
  return closed ? std::optional<std::string>(body) : std::nullopt;
}

}  // namespace

std::string http_get(const std::array<std::uint8_t, 16>& address, std::uint16_t port,
                     const std::string& path) {
  const std::string host = text(Endpoint{address, port});
  Exchange exchange(address, port, path);
  exchange.send(
      fmt::format("GET {} HTTP/1.0\r\nHost: {}\r\nConnection: close\r\n\r\n", path, host));
  const std::string answer =
      exchange.answer([](const std::string& part) { return body_of(part, false).has_value(); });
  // "HTTP/1.1 200 OK", headers, an empty line, the body.
  const bool is_http = answer.starts_with("HTTP/1.") && answer.size() > 12;
  if (!is_http) exchange.fail("something that is no HTTP");
  if (answer.compare(8, 4, " 200") != 0) {
    const std::string status = answer.substr(9, 3);
    const bool is_number =
        std::ranges::all_of(status, [](unsigned char c) { return c >= '0' && c <= '9'; });
    exchange.fail(is_number ? "status " + status : "something that is no HTTP");
  }
  const std::optional<std::string> body = body_of(answer, true);
  if (!body) exchange.fail("an answer that was cut off");
  return *body;
}

}  // namespace hqslam::live
