#pragma once

#include "hqslam/core/scan_source.h"
#include "hqslam/recordings/ouster.h"
#include "hqslam/recordings/velodyne.h"
#include "testing.h"

namespace hqslam::test {

using Payload = std::vector<std::uint8_t>;

/// A datagram as it was captured.
struct Captured {
  std::int64_t time_ns = 0;
  std::uint16_t port = 2368;
  Payload payload;
  std::uint8_t sender = 201;  ///< the last number of 192.168.1.x
};

template <typename T>
void put(Payload& bytes, std::size_t at, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes[at + i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
  }
}

/// Numbers, low byte first, and bytes as they are, one after the other.
void append(std::string& bytes, const auto&... values) {
  const auto append_one = [&](const auto& value) {
    if constexpr (requires { value.begin(); }) {
      bytes.append(value.begin(), value.end());
    } else {
      bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
    }
  };
  (append_one(values), ...);
}

/// Ethernet, IPv4 and UDP headers around the payload; cut into fragments of at most
/// `fragment_bytes` (a multiple of 8), 0: whole.
std::vector<Payload> ethernet_frames(const Captured& captured, std::size_t fragment_bytes = 0);

/// The bytes of a .pcap file (microseconds) or of a .pcapng file (nanoseconds).
std::string pcap_bytes(const std::vector<Captured>& packets, std::size_t fragment_bytes = 0);
std::string pcapng_bytes(const std::vector<Captured>& packets);

/// A .pcap file of these packets in a folder of its own.
struct Capture {
  TemporaryDirectory folder;
  std::string path = folder.file("a.pcap");

  explicit Capture(const std::vector<Captured>& packets, std::size_t fragment_bytes = 0) {
    write_file(path, pcap_bytes(packets, fragment_bytes));
  }
};

/// What a .pcapng file says of an interface; Ethernet is link type 1.
std::string pcapng_interface(std::uint16_t link_type);

/// A Velodyne's data packet: 12 blocks with these azimuths (hundredths of a degree), all
/// measurements of `distance` and `intensity`.
Payload velodyne_packet(std::uint32_t time_us, const std::vector<int>& azimuths,
                        std::uint16_t distance = 2500, std::uint8_t intensity = 10,
                        std::uint8_t return_mode = 0x37, std::uint8_t product = 0x22);
/// Changes one measurement of it.
void set_measurement(Payload& packet, int block, int channel, std::uint16_t distance,
                     std::uint8_t intensity = 10);

/// What a sensor in a round room sends: whole packets from `first_azimuth_deg` on for
/// `duration_s`; time 0 is at `start_ns`.
struct RoundRoom {
  double rate_hz = 10.0;
  double duration_s = 0.35;
  double first_azimuth_deg = 300.0;
  double firing_us = 110.592;  ///< from block to block
  bool dual = false;
  std::uint8_t product = 0x22;
  double blind_from_deg = 0.0;  ///< nothing is sent between these, clockwise
  double blind_to_deg = 0.0;
  std::int64_t start_ns = 1'600'000'000'000'000'000;
};
std::vector<Captured> velodyne_capture(const RoundRoom& room = {});

/// A Hesai XT's packet: 8 blocks from this azimuth on (hundredths of a degree), 0.18 degrees apart
/// (of two returns every other one), all measurements of `distance` (4 mm); 10 s after 2020-09-13
/// 12:26:30 plus `time_us`.
Payload hesai_packet_bytes(int lasers, std::uint32_t time_us, int azimuth, std::uint32_t number,
                           std::uint8_t return_mode = 0x37, std::uint16_t distance = 1250);
/// Changes one measurement of it.
void set_hesai_measurement(Payload& packet, int lasers, int block, int laser,
                           std::uint16_t distance, std::uint8_t reflectivity = 10);
/// What such a sensor sends in a round room in this many seconds, 10 turns a second, from the
/// azimuth of 300 degrees on.
std::vector<Captured> hesai_capture(int lasers, double duration_s, std::uint8_t return_mode = 0x37);

/// What a RoboSense in a round room sends in this many seconds, 10 turns a second, from the azimuth
/// of 300 degrees on and from 2020-09-13 12:26:40, all measurements of `distance` and reflectivity
/// 10; its settings first, to port 7788. Beams of an RS-16: -15 to -1 and 15 to 1 degrees; of a
/// Helios of `lasers` beams from 15 degrees down, every other one a degree clockwise aside.
struct Robosense {
  bool helios = false;
  int lasers = 16;
  bool dual = false;
  std::uint16_t distance = 1000;
};
Payload robosense_settings(const Robosense& sensor);
std::vector<Captured> robosense_capture(const Robosense& sensor, double duration_s);
/// Changes one of the 32 measurements of a block.
void set_robosense_measurement(Payload& packet, int block, int channel, std::uint16_t distance,
                               std::uint8_t reflectivity = 10);

inline constexpr std::array kOusterProfiles = {
    recordings::OusterProfile::kLegacy, recordings::OusterProfile::kRng19,
    recordings::OusterProfile::kRng19Dual, recordings::OusterProfile::kRng15,
    recordings::OusterProfile::kFusaDual};
/// Metadata of a small Ouster with `rows` beams and 512 columns at 20 Hz.
std::string ouster_metadata_text(recordings::OusterProfile profile, int rows = 8);

/// The lidar packets of one of its turns: range of row r at column c is 2000 + 10 r + c mm, rounded
/// down to the profile's unit; the second return is 500 mm farther.
std::vector<Captured> ouster_turn(recordings::OusterProfile profile, std::uint32_t frame_id,
                                  int rows = 8);
/// The same of an Ouster whose beam `row` measures range_mm(row, column).
std::vector<Captured> ouster_turn(const recordings::OusterMetadata& metadata,
                                  std::uint32_t frame_id,
                                  const std::function<std::uint32_t(int, int)>& range_mm);

/// Those of the turns with these numbers.
std::vector<Captured> ouster_turns(recordings::OusterProfile profile,
                                   const std::vector<std::uint32_t>& frame_ids);

/// An Ouster's packet of inertial data of this time: 1 g upwards and 0.25 g forwards, 90 degrees a
/// second to the left.
Payload ouster_imu_packet(std::int64_t time_ns);

recordings::Packet as_packet(const Captured& captured);

/// The turns that a decoder makes of packets, to the last one.
auto decoded(auto& decoder, const std::vector<Captured>& packets) {
  for (const Captured& packet : packets) decoder.add(as_packet(packet));
  decoder.finish();
  return decoder.take_scans();
}

/// Whether they have the same stamps and ranges.
bool same_scans(const std::vector<RecordedScan>& a, const std::vector<RecordedScan>& b);

/// All scans of a recording from where it stands.
std::vector<RecordedScan> all_scans(ScanSource& source);
inline std::vector<RecordedScan> all_scans(ScanSource&& source) { return all_scans(source); }

}  // namespace hqslam::test
