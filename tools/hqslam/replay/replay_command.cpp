#include <arpa/inet.h>
#include <fmt/ranges.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <set>
#include <string>
#include <thread>

#include "hqslam/core/error.h"
#include "hqslam/core/file_descriptor.h"
#include "hqslam/recordings/packet.h"
#include "product.h"
#include "terminal/command_options.h"
#include "terminal/progress.h"
#include "terminal/terminal.h"
#include "timing/timing.h"

namespace hqslam::tools {
namespace {

struct ReplayOptions {
  std::string capture;
  std::string to = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: those of the capture
  double speed = 1.0;
};

/// Sends datagrams to the ports of one computer.
class UdpSender {
 public:
  explicit UdpSender(const std::string& address) : name_(address) {
    if (inet_pton(AF_INET, address.c_str(), &ipv4_.sin_addr) == 1) {
      ipv4_.sin_family = AF_INET;
    } else if (inet_pton(AF_INET6, address.c_str(), &ipv6_.sin6_addr) == 1) {
      ipv6_.sin6_family = AF_INET6;
    } else {
      throw Error("--to {}: expected an IPv4 or IPv6 address, found none; give one as 192.168.1.7",
                  address);
    }
    socket_ =
        FileDescriptor(::socket(is_ipv4() ? AF_INET : AF_INET6, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  }

  /// Throws Error if the system cannot send. Whether a program listens there makes no difference.
  void send(std::span<const std::uint8_t> payload, std::uint16_t port) {
    ipv4_.sin_port = ipv6_.sin6_port = htons(port);
    const void* to = is_ipv4() ? static_cast<const void*>(&ipv4_) : &ipv6_;
    const socklen_t bytes = is_ipv4() ? sizeof ipv4_ : sizeof ipv6_;
    if (sendto(socket_.get(), payload.data(), payload.size(), MSG_NOSIGNAL,
               static_cast<const sockaddr*>(to), bytes) >= 0 ||
        errno == ECONNREFUSED) {
      return;
    }
    throw Error("--to {}: the system cannot send there ({}); give another address", name_,
                std::strerror(errno));
  }

 private:
  bool is_ipv4() const { return ipv4_.sin_family == AF_INET; }

  std::string name_;
  sockaddr_in ipv4_{};
  sockaddr_in6 ipv6_{};
  FileDescriptor socket_;
};

void declare(CLI::App& app, ReplayOptions& options) {
  Command command =
      add_command(app, "replay", "Send the packets of a capture by UDP, as the sensor did",
                  "Packets keep the intervals at which they were captured. In a second terminal:\n"
                  "  hqslam live --sensor vlp-16 --out results/live --view\n"
                  "For an Ouster give hqslam live the metadata file of the capture: a replay does\n"
                  "not answer requests for it.");
  command
      .option("CAPTURE", &options.capture, ".pcap or .pcapng file",
              {.required = true, .given = Given::kFile})
      .option("--to", &options.to, "Address of the computer that receives", {.shows_default = true})
      .option("--port", &options.port,
              "UDP port to which all packets go (default: those to which they were captured)",
              {.within = std::pair(1, 65535)})
      .option("--speed", &options.speed, "Factor on the speed of the capture",
              {.shows_default = true, .within = std::pair(0.01, 100.0)});
}

int run(const ReplayOptions& options) {
  const InterruptGuard interrupt;
  UdpSender sender(options.to);
  const auto capture = recordings::open_pcap(options.capture);
  Progress progress("replay", std::nullopt, stderr, "packets");
  std::set<std::uint16_t> ports;
  std::optional<std::int64_t> first_ns;
  std::int64_t sent = 0;
  const SteadyClock::time_point start = SteadyClock::now();
  while (!interrupt.stop_requested()) {
    const std::optional<recordings::Packet> packet = capture->next();
    if (!packet) break;
    if (!first_ns) first_ns = packet->capture_time_ns;
    const double due_s = 1e-9 * static_cast<double>(packet->capture_time_ns - *first_ns);
    std::this_thread::sleep_until(start +
                                  std::chrono::duration_cast<SteadyClock::duration>(
                                      std::chrono::duration<double>(due_s / options.speed)));
    const std::uint16_t port = options.port != 0 ? options.port : packet->endpoint.port;
    sender.send(packet->payload, port);
    ports.insert(port);
    progress.update(++sent, capture->read_share());
  }
  progress.finish();
  to_stdout("{} packets sent to {}, UDP port {}, in {:.1f} s\n", sent, options.to,
            fmt::join(ports, ", "), seconds_since(start));
  if (const std::string complaint = capture->complaint(); !complaint.empty()) {
    to_stderr("hqslam: {}: {}\n", options.capture, complaint);
  }
  return interrupt.stop_requested() ? kInterrupted : kOk;
}

}  // namespace

void add_replay(CLI::App& app, Chosen& chosen) { add_subcommand<ReplayOptions>(app, chosen); }

}  // namespace hqslam::tools
