#include "captures.h"
#include "hqslam/recordings/recording.h"
#include "input_file.h"
#include "made_images.h"
#include "packets/hesai_decoder.h"
#include "packets/ouster_decoder.h"
#include "packets/robosense_decoder.h"
#include "packets/velodyne_decoder.h"

namespace hqslam::fuzz {
namespace {

using namespace hqslam::recordings;

/// Few: the readers are to be fed, not the projection.
constexpr int kColumns = 16;

/// As hqslam info and hqslam run read a capture or a bag, if it begins as one.
void read_recording(const std::string& path) {
  if (!is_capture_or_bag(path)) return;
  auto source = Recording::open(path, {.sensor = "vlp-16", .columns = kColumns});
  while (true) {
    try {
      if (!source.next()) break;
    } catch (const ScanError&) {
      continue;  // left out
    }
  }
}

/// Packets of `bytes`, a millisecond apart.
void for_each_packet(Bytes input, std::size_t bytes, const auto& add) {
  Packet packet;
  for (std::size_t at = 0; at + bytes <= input.size(); at += bytes) {
    packet.payload = input.subspan(at, bytes);
    packet.capture_time_ns += 1'000'000;
    add(packet);
  }
}

/// What a decoder makes of packets, as images of the sensor.
void read_scans(auto decoder, Bytes packets, std::size_t bytes) {
  for_each_packet(packets, bytes, [&](const Packet& p) { decoder.add(p); });
  decoder.finish();
  while (decoder.next()) continue;
}

}  // namespace

void pcap(Bytes input) { read_recording(as_file(input, ".pcap")); }
void db3(Bytes input) { read_recording(as_file(input, ".db3")); }
void mcap(Bytes input) { read_recording(as_file(input, ".mcap")); }
void ros1_bag(Bytes input) { read_recording(as_file(input, ".bag")); }

void ouster_json(Bytes input) {
  ouster_metadata_from_json({reinterpret_cast<const char*>(input.data()), input.size()}, "input");
}

void velodyne_packets(Bytes input) {
  if (input.empty()) return;
  const VelodyneModel model = kVelodyneModels[input[0] % 4U];
  VelodyneProbe probe;
  const Bytes packets = input.subspan(1);
  for_each_packet(packets, kVelodynePacketBytes, [&](const Packet& p) { probe.add(p); });
  VelodyneStream stream = probe.result(model).value_or(VelodyneStream{});
  stream.model = model;
  const SensorModel sensor = test::preset_with(std::string(name(model)), kColumns);
  const KeptReturn kept = (input[0] & 4U) != 0 ? KeptReturn::kLast : KeptReturn::kStrongest;
  read_scans(VelodyneDecoder(stream, sensor, {.kept_return = kept}), packets, kVelodynePacketBytes);
}

void hesai_packets(Bytes input) {
  if (input.empty()) return;
  const int lasers = (input[0] & 1U) != 0 ? 32 : 16;
  SensorModel sensor = nominal_hesai(lasers);
  sensor.columns = kColumns;
  const KeptReturn kept = (input[0] & 2U) != 0 ? KeptReturn::kLast : KeptReturn::kStrongest;
  read_scans(HesaiDecoder(sensor, {.kept_return = kept}), input.subspan(1),
             lasers == 16 ? 568 : 1080);
}

void robosense_packets(Bytes input) {
  if (input.size() <= kRobosenseBytes) return;
  const Bytes settings = input.subspan(1, kRobosenseBytes);
  const RobosenseUnit unit = robosense_unit(settings, (input[0] & 1U) != 0, "fuzzed");
  SensorModel sensor = unit.sensor;
  sensor.columns = kColumns;
  read_scans(RobosenseDecoder(unit, sensor), input.subspan(1 + kRobosenseBytes), kRobosenseBytes);
}

void hesai_angles(Bytes input) { read_hesai_angles(as_whole_file(input, ".csv")); }

namespace {

/// A turn of four packets.
constexpr int kOusterColumns = 64;

/// What is made once for a sensor and serves all its frames.
struct OusterReader {
  OusterMetadata metadata;
  DecoderOptions options;
  OusterGeometry geometry{metadata, options};
};

std::vector<OusterReader> ouster_readers() {
  std::vector<OusterReader> readers;
  for (const KeptReturn kept : {KeptReturn::kStrongest, KeptReturn::kLast}) {
    for (const OusterProfile profile : test::kOusterProfiles) {
      OusterMetadata metadata =
          ouster_metadata_from_json(test::ouster_metadata_text(profile, kOusterRows), "metadata");
      metadata.sensor.columns = kOusterColumns;
      metadata.last_column = kOusterColumns - 1;
      readers.push_back({std::move(metadata), {.kept_return = kept}});
    }
  }
  return readers;
}

}  // namespace

void ouster_packets(Bytes input) {
  if (input.empty()) return;
  static std::vector<OusterReader> readers = ouster_readers();
  OusterReader& reader = readers[input[0] % readers.size()];
  OusterDecoder decoder(reader.metadata, reader.options);
  for_each_packet(input.subspan(1), reader.metadata.packet_bytes(),
                  [&](const Packet& p) { decoder.add(p); });
  decoder.finish();
  for (const OusterFrame& frame : decoder.take_scans()) reader.geometry.scan(frame);
}

}  // namespace hqslam::fuzz
