#include "pcap_writer.h"

#include "core/recordings/captures.h"

using namespace hqslam::live;
using namespace hqslam::recordings;

TEST_CASE("captures have packets of any sender and size, overwrite nothing and are never empty") {
  const TemporaryDirectory folder;
  std::vector<Captured> packets;
  for (const std::size_t bytes : {0, 1, 1206, 12609, 65000}) {
    packets.push_back({1'600'000'000'123'456'789 + static_cast<std::int64_t>(bytes), 7502,
                       Payload(bytes, static_cast<std::uint8_t>(bytes)), 9});
  }
  Packet from_ipv6 = as_packet(packets[2]);
  from_ipv6.endpoint.address = {0xFE, 0x80, 0, 0, 0, 0, 0, 0, 2, 3, 4, 5, 6, 7, 8, 9};
  {
    PcapWriter writer(folder.file("a.pcap"));
    for (const Captured& packet : packets) writer.add(as_packet(packet));
    writer.add(from_ipv6);
  }
  const auto source = open_pcap(folder.file("a.pcap"));
  for (const Captured& packet : packets) {
    const auto read = source->next().value();
    CHECK(read.capture_time_ns == packet.time_ns);
    CHECK(read.endpoint == as_packet(packet).endpoint);
    CHECK(Payload(read.payload.begin(), read.payload.end()) == packet.payload);
  }
  const auto last = source->next().value();
  CHECK(last.endpoint == from_ipv6.endpoint);
  CHECK(last.payload.size() == 1206);
  CHECK_FALSE(source->next());
  CHECK(refused_with([&] { PcapWriter(folder.file("a.pcap")); }, "a.pcap", "another file"));
  CHECK(refused_with([&] { PcapWriter(folder.file("a.txt")); }, ".pcap"));
  write_file(folder.file("b.json"), "{}");
  CHECK(refused_with([&] { PcapWriter(folder.file("b.pcap")); }, "b.json"));
  for (int attempt = 0; attempt < 2; ++attempt) {
    const PcapWriter writer(folder.file("empty.pcap"));
    CHECK(std::filesystem::exists(folder.file("empty.pcap")));  // nobody else may take the name
  }
  CHECK_FALSE(std::filesystem::exists(folder.file("empty.pcap")));
}
