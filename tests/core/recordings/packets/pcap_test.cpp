#include "captures.h"
#include "packets/ip_datagram.h"

using namespace hqslam::recordings;

namespace {

struct Read {
  std::vector<Captured> packets;
  std::string complaint;
};

Read read(const std::string& bytes) {
  const TemporaryDirectory directory;
  write_file(directory.file("a.pcap"), bytes);
  const auto source = open_pcap(directory.file("a.pcap"));
  Read result;
  while (const auto packet = source->next()) {
    result.packets.push_back({packet->capture_time_ns, packet->endpoint.port,
                              Payload(packet->payload.begin(), packet->payload.end())});
    CHECK(text(packet->endpoint) == "192.168.1.201:" + std::to_string(packet->endpoint.port));
  }
  result.complaint = source->complaint();
  return result;
}

std::vector<Captured> some_packets() {
  std::vector<Captured> packets;
  for (int i = 0; i < 5; ++i) {
    Payload payload(static_cast<std::size_t>(3000 + i));
    for (std::size_t k = 0; k < payload.size(); ++k) {
      payload[k] = static_cast<std::uint8_t>(k * 7 + static_cast<std::size_t>(i));
    }
    packets.push_back({1'600'000'000'123'456'000 + i * 1'000'000, 7502, payload});
  }
  return packets;
}

/// Two fragments of a datagram with this number.
std::vector<Payload> frames_of(int number, std::uint8_t content = 0) {
  return ethernet_frames({number * 1000, 7502, Payload(2000, content), 201}, 1480);
}

void check_same(const std::vector<Captured>& found, const std::vector<Captured>& expected) {
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(found[i].time_ns == expected[i].time_ns);
    CHECK(found[i].port == expected[i].port);
    CHECK(found[i].payload == expected[i].payload);
  }
}

}  // namespace

TEST_CASE("datagrams of .pcap and .pcapng files come out as they were sent") {
  check_same(read(pcap_bytes(some_packets())).packets, some_packets());
  auto nanoseconds = some_packets();
  nanoseconds[2].time_ns += 789;
  check_same(read(pcapng_bytes(nanoseconds)).packets, nanoseconds);
}

TEST_CASE("fragments are put together, in whichever order they come") {
  check_same(read(pcap_bytes(some_packets(), 1480)).packets, some_packets());
  IpDatagrams datagrams;
  for (const Captured& captured : some_packets()) {
    auto frames = ethernet_frames(captured, 800);
    REQUIRE(frames.size() == 4);
    std::swap(frames[0], frames[3]);
    frames.insert(frames.begin() + 1, frames[0]);  // and one of them twice
    int complete = 0;
    for (const Payload& frame : frames) {
      const auto datagram = datagrams.add(Bytes(frame).subspan(14));
      if (!datagram) continue;
      ++complete;
      CHECK(Payload(datagram->payload.begin(), datagram->payload.end()) == captured.payload);
    }
    CHECK(complete == 1);
  }
  CHECK(datagrams.incomplete() == 0);
}

TEST_CASE("of unfinished datagrams the latest 64 are kept") {
  const auto add = [](IpDatagrams& datagrams, const Payload& frame) {
    return datagrams.add(Bytes(frame).subspan(14)).has_value();
  };
  for (const int begun : {64, 65}) {
    IpDatagrams datagrams;
    for (int i = 0; i < begun; ++i) CHECK_FALSE(add(datagrams, frames_of(i)[0]));
    CHECK(add(datagrams, frames_of(begun - 1)[1]));
    CHECK(add(datagrams, frames_of(0)[1]) == (begun == 64));
  }
}

TEST_CASE("a fragment waits for the others of its datagram for at most 4096 packets") {
  for (const int between : {4095, 4096}) {
    IpDatagrams datagrams;
    const auto add = [&](const Payload& frame) {
      const auto datagram = datagrams.add(Bytes(frame).subspan(14));
      return datagram ? Payload(datagram->payload.begin(), datagram->payload.end()) : Payload();
    };
    CHECK(add(frames_of(7, 1)[1]).empty());
    for (int i = 0; i < between; ++i) add(ethernet_frames({1000, 2368, Payload(8), 201}).front());
    // The numbers begin again after 65,536 datagrams: a seventh one of other content.
    const auto later = frames_of(7, 2);
    CHECK(add(later[0]).empty() == (between == 4096));
    CHECK(add(later[1]) == (between == 4096 ? Payload(2000, 2) : Payload()));
    CHECK(datagrams.incomplete() == 1);
  }
}

TEST_CASE("a fragment that reaches beyond the largest datagram is damage") {
  for (const bool beyond : {false, true}) {
    Payload frame = ethernet_frames({0, 7502, Payload(16), 201}).front();  // with UDP 24 bytes
    const int units = beyond ? 8190 : 8188;                                // 65520 or 65504
    frame[20] = static_cast<std::uint8_t>(units >> 8);
    frame[21] = static_cast<std::uint8_t>(units);
    IpDatagrams datagrams;
    CHECK_FALSE(datagrams.add(Bytes(frame).subspan(14)));
    CHECK(datagrams.damaged() == (beyond ? 1 : 0));
  }
}

TEST_CASE("an IP length beyond the frame is no damage where UDP's own length is whole") {
  Captured positions{1'600'000'000'000'000'000, 8308, Payload(512, 3)};
  Payload frame = ethernet_frames(positions).front();
  frame[16] = 1234 >> 8;
  frame[17] = 1234 & 0xFF;
  IpDatagrams datagrams;
  CHECK(datagrams.add(Bytes(frame).subspan(14)).value().payload.size() == 512);
  CHECK(datagrams.damaged() == 0);
  frame.resize(frame.size() - 1);  // and here something is missing
  CHECK_FALSE(datagrams.add(Bytes(frame).subspan(14)));
  CHECK(datagrams.damaged() == 1);
}

TEST_CASE("a capture that ends in the middle of a frame ends before it") {
  const std::string bytes = pcap_bytes(some_packets());
  CHECK(read(bytes.substr(0, bytes.size() - 10)).packets.size() == 4);
}

TEST_CASE("packets that were cut as they were recorded are left out; how to keep them is named") {
  std::string bytes = pcap_bytes({some_packets()[0]});
  bytes.resize(24 + 16 + 800);
  const Read cut = read(bytes.replace(24 + 8, 2, "\x20\x03"));  // 800 bytes of the frame
  CHECK(cut.packets.empty());
  CHECK(cut.complaint ==
        "1 damaged or cut packets were left out: tcpdump keeps whole ones with -s 0");
}

TEST_CASE("a capture that cannot be read on says so, and is refused if nothing was read of it") {
  // A second interface, of raw IP: libpcap reads only captures of one link type.
  const std::string second = pcapng_interface(101);
  const std::string bytes = pcapng_bytes(some_packets());
  const Read part = read(bytes + second + pcapng_bytes(some_packets()).substr(28 + 32));
  check_same(part.packets, some_packets());
  CHECK(one_line_with(part.complaint, "could not be read on", "type"));
  CHECK(read(bytes).complaint.empty());
  CHECK(read(bytes.substr(0, bytes.size() - 10)).complaint.empty());
  const std::size_t headers = 28 + 32;
  const std::string nothing = bytes.substr(0, headers) + second + bytes.substr(headers);
  CHECK(refused_with([&] { read(nothing); }, "a.pcap", "type"));
}

TEST_CASE("what is no capture is refused in one line") {
  const TemporaryDirectory directory;
  CHECK(refused_with([&] { open_pcap(directory.file("none.pcap")); }, "none.pcap", "no such file"));
  write_file(directory.file("text.pcap"), "this is no capture, however long it may be");
  CHECK(refused_with([&] { open_pcap(directory.file("text.pcap")); }, "text.pcap", ".pcapng"));
  std::string radio = pcap_bytes(some_packets());
  radio[20] = 127;  // IEEE 802.11 with radio information
  write_file(directory.file("radio.pcap"), radio);
  CHECK(refused_with([&] { open_pcap(directory.file("radio.pcap")); }, "link type"));
}
