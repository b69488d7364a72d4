// Sends the packets of a capture to a UDP port of this computer, over and over, as if the sensor
// went on: what measurements of `hqslam live` are made with; no test by itself.
//   replay_capture CAPTURE PORT SECONDS [SPEED] [METADATA.json]
// A Velodyne's time, and an Ouster's times and numbers of turns, run on from round to round.
#include <chrono>
#include <cstdio>
#include <optional>
#include <string>
#include <thread>

#include "hqslam/recordings/ouster.h"
#include "loopback.h"
#include "packets/ouster_metadata.h"
#include "packets/velodyne_tables.h"

using namespace hqslam;
using namespace hqslam::recordings;
using namespace hqslam::test;

namespace {

/// The packets of one kind: of an Ouster's size, or a Velodyne's.
std::vector<Captured> packets_of(const std::string& path,
                                 const std::optional<OusterMetadata>& metadata) {
  std::vector<Captured> packets;
  const auto source = open_pcap(path);
  while (const auto packet = source->next()) {
    const bool wanted = metadata ? packet->payload.size() == metadata->packet_bytes()
                                 : is_velodyne_packet(packet->payload);
    if (!wanted) continue;
    packets.push_back({packet->capture_time_ns, packet->endpoint.port,
                       Payload(packet->payload.begin(), packet->payload.end())});
  }
  return packets;
}

/// One round later: times later by `round_ns`, turns by `turns`.
void move_on(Payload& packet, const OusterMetadata& metadata, std::uint64_t round_ns,
             std::uint32_t turns) {
  const OusterLayout& of = layout(metadata.profile);
  const std::size_t column_bytes = of.column_header + of.column_footer +
                                   of.pixel * static_cast<std::size_t>(metadata.sensor.rows());
  const std::uint32_t id = frame_id(packet, metadata.profile) + turns;
  if (metadata.profile == OusterProfile::kFusaDual) {
    put(packet, 4, id);
  } else if (metadata.profile != OusterProfile::kLegacy) {
    put(packet, 2, static_cast<std::uint16_t>(id));
  }
  for (int i = 0; i < metadata.columns_per_packet; ++i) {
    const std::size_t at = of.packet_header + column_bytes * static_cast<std::size_t>(i);
    put(packet, at, little_endian<std::uint64_t>(packet, at) + round_ns);
    if (metadata.profile == OusterProfile::kLegacy) {
      put(packet, at + 10, static_cast<std::uint16_t>(id));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "replay_capture CAPTURE PORT SECONDS [SPEED] [METADATA.json]\n");
    return 2;
  }
  const double seconds = std::stod(argv[3]);
  const double speed = argc > 4 ? std::stod(argv[4]) : 1.0;
  std::optional<OusterMetadata> metadata;
  if (argc > 5) metadata = read_ouster_metadata(argv[5]);
  std::vector<Captured> packets = packets_of(argv[1], metadata);
  if (packets.size() < 2) return 2;
  const double spacing_ns = static_cast<double>(packets.back().time_ns - packets[0].time_ns) /
                            static_cast<double>(packets.size() - 1);
  auto round_ns = static_cast<std::int64_t>(spacing_ns * static_cast<double>(packets.size()));
  std::uint32_t turns = 0;
  if (metadata) {  // captures of single turns have capture times of no meaning
    turns = frame_id(packets.back().payload, metadata->profile) -
            frame_id(packets[0].payload, metadata->profile) + 1;
    round_ns = static_cast<std::int64_t>(1e9 * turns * metadata->sensor.scan_period_s);
    for (std::size_t i = 0; i < packets.size(); ++i) {
      packets[i].time_ns =
          static_cast<std::int64_t>(i) * round_ns / static_cast<std::int64_t>(packets.size());
    }
  }
  const LoopbackSender sender(static_cast<std::uint16_t>(std::stoi(argv[2])));
  const auto start = std::chrono::steady_clock::now();
  for (std::int64_t round = 0;; ++round) {
    for (Captured& packet : packets) {
      const double at_ns =
          static_cast<double>(packet.time_ns - packets[0].time_ns + round * round_ns) / speed;
      if (at_ns > 1e9 * seconds) return 0;
      std::this_thread::sleep_until(start +
                                    std::chrono::nanoseconds(static_cast<std::int64_t>(at_ns)));
      sender.send(packet.payload);
      if (metadata) {
        move_on(packet.payload, *metadata, static_cast<std::uint64_t>(round_ns), turns);
      } else {
        const auto time_us = little_endian<std::uint32_t>(packet.payload, kTimeAt);
        put(packet.payload, kTimeAt,
            static_cast<std::uint32_t>((time_us + round_ns / 1000) % kHour_us));
      }
    }
  }
}
