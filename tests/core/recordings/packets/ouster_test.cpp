#include "captures.h"
#include "core/real_data.h"
#include "hash.h"
#include "packets/ouster_decoder.h"

using namespace hqslam::recordings;

namespace {

OusterMetadata small_metadata(OusterProfile profile) {
  return ouster_metadata_from_json(ouster_metadata_text(profile), "a test");
}

}  // namespace

TEST_CASE("fields stand where Ouster's own decoder reads them") {
  // The values that ouster-sdk 1.0.1 reads from packets of 32 beams whose byte i is i mod 251.
  const auto packet = [](std::size_t bytes) {
    Payload result(bytes);
    for (std::size_t i = 0; i < bytes; ++i) result[i] = static_cast<std::uint8_t>(i % 251);
    return result;
  };
  struct Expected {
    OusterProfile profile;
    std::size_t bytes;
    std::uint32_t frame;
    std::uint64_t serial;
    std::uint32_t ranges[2], second_ranges[2];
    std::uint64_t second_timestamp;
    std::uint16_t reflectivities[2], second_reflectivities[2];
  };
  using enum OusterProfile;
  // clang-format off
  const Expected expected[] = {
      {kLegacy, 6464, 0xb0a, 0, {0x21110, 0xe1d1c}, {}, 0xa09f9e9d9c9b9a99, {0x1514, 0x2120}, {}},
      {kRng19, 6400, 0x302, 0xb0a090807, {0x62d2c, 0x23938}, {}, 0xb8b7b6b5b4b3b2b1, {48, 60}, {}},
      {kRng19Dual, 8448, 0x302, 0xb0a090807, {0x62d2c, 0x63d3c}, {0x23130, 0x24140},
       0x3d3c3b3a39383736, {47, 63}, {51, 67}},
      {kRng15, 2304, 0x302, 0xb0a090807, {0x16960, 0x18980}, {}, 0xb3b2b1b0afaeadac, {46, 50}, {}},
      {kFusaDual, 4352, 0x7060504, 0xf0e0d0c0b, {0x16960, 0x1a9a0}, {0x18980, 0x1c9c0},
       0x3837363534333231, {46, 54}, {50, 58}}};
  // clang-format on
  for (const Expected& e : expected) {
    CAPTURE(name(e.profile));
    OusterMetadata metadata = small_metadata(e.profile);
    metadata.pixels_per_column = 32;
    REQUIRE(metadata.packet_bytes() == e.bytes);
    const Payload bytes = packet(e.bytes);
    const OusterLayout& of = layout(e.profile);
    CHECK(frame_id(bytes, e.profile) == e.frame);
    CHECK(serial_number(bytes, e.profile) == e.serial);
    const std::size_t first = of.packet_header + of.column_header;
    for (std::size_t row = 0; row < 2; ++row) {
      const std::uint8_t* const pixel = bytes.data() + first + row * of.pixel;
      CHECK(range_mm(pixel, of) == e.ranges[row]);
      CHECK(reflectivity(pixel, of) == e.reflectivities[row]);
      if (of.second_range_at > 0) {
        CHECK(range_mm(pixel + of.second_range_at, of) == e.second_ranges[row]);
        CHECK(reflectivity(pixel + of.second_range_at, of) == e.second_reflectivities[row]);
      }
    }
    const std::size_t column = (e.bytes - of.packet_header - of.packet_footer) / 16;
    CHECK(little_endian<std::uint64_t>(bytes, of.packet_header + column) == e.second_timestamp);
  }
}

TEST_CASE("every profile gives the ranges that were put into it") {
  for (const OusterProfile profile : kOusterProfiles) {
    CAPTURE(name(profile));
    OusterDecoder decoder(small_metadata(profile));
    const auto frames = decoded(decoder, ouster_turns(profile, {65534, 65535, 65536}));
    REQUIRE(frames.size() == 3);
    CHECK(decoder.lost_scans() == 0);
    CHECK(decoder.counts().used == 96);
    CHECK(decoder.counts().lost + decoder.counts().late + decoder.counts().foreign == 0);
    const std::uint32_t unit =
        profile == OusterProfile::kRng15 || profile == OusterProfile::kFusaDual ? 8 : 1;
    for (std::uint32_t row = 0; row < 8; ++row) {
      for (std::uint32_t column = 0; column < 512; ++column) {
        const std::uint32_t range_mm = 2000 + 10 * row + column;
        CHECK(frames[1].range_mm[row * 512 + column] == range_mm / unit * unit);
        if (small_metadata(profile).dual_return()) {
          CHECK(frames[1].second_range_mm[row * 512 + column] == (range_mm + 500) / unit * unit);
        }
      }
    }
  }
}

TEST_CASE("beams that old firmware lists as 0 and 0, and their pixels, are left out") {
  std::string text = ouster_metadata_text(OusterProfile::kLegacy, 5);
  text = replaced_in(text, "[10, 5, 0, -5, -10]", "[0, 5, 0, -5, 0]");
  OusterDecoder decoder(
      ouster_metadata_from_json(replaced_in(text, "2, -1, 2, -1, 2", "0, -1, 0, -1, 0"), "a test"));
  const auto frames = decoded(decoder, ouster_turn(OusterProfile::kLegacy, 1, 5));
  REQUIRE(frames.size() == 1);
  REQUIRE(frames[0].range_mm.size() == std::size_t{2 * 512});
  CHECK(frames[0].range_mm[100] == 2000 + 10 * 1 + 100);
  CHECK(frames[0].range_mm[512 + 100] == 2000 + 10 * 3 + 100);
}

TEST_CASE("a pixel's point is that of the documented formula") {
  const OusterMetadata metadata = small_metadata(OusterProfile::kLegacy);
  OusterDecoder decoder(metadata);
  const auto frames = decoded(decoder, ouster_turns(OusterProfile::kLegacy, {3}));
  REQUIRE(frames.size() == 1);
  OusterGeometry geometry(metadata);
  const auto scan = geometry.scan(frames[0]).value();
  for (const int row : {0, 1, 7}) {
    for (const int measured : {0, 1, 100, 256, 511}) {
      CAPTURE(row);
      CAPTURE(measured);
      const double range_mm = 2000.0 + 10 * row + measured;
      const double azimuth_deg = row % 2 == 0 ? 2.0 : -1.0;  // clockwise, as the file has it
      const double altitude = (10.0 - 20.0 * row / 7.0) * std::numbers::pi / 180.0;
      const double encoder = 2.0 * std::numbers::pi * (1.0 - measured / 512.0);
      const double beam = encoder - azimuth_deg * std::numbers::pi / 180.0;
      const double n_mm = 20.0;
      const Eigen::Vector3d lidar_mm(
          (range_mm - n_mm) * std::cos(beam) * std::cos(altitude) + n_mm * std::cos(encoder),
          (range_mm - n_mm) * std::sin(beam) * std::cos(altitude) + n_mm * std::sin(encoder),
          (range_mm - n_mm) * std::sin(altitude));
      const Eigen::Vector3f expected_m(static_cast<float>(-1e-3 * lidar_mm.x()),
                                       static_cast<float>(-1e-3 * lidar_mm.y()),
                                       static_cast<float>(1e-3 * lidar_mm.z()));
      const int column = (measured - metadata.sensor.column_shift(row) + 512) % 512;
      const std::size_t pixel = scan.cloud.index(row, column);
      CHECK((scan.cloud.points_m[pixel] - expected_m).norm() < 2e-6F);
      // The pixel is the one that contains the beam's direction.
      const float azimuth_rad =
          std::atan2(-static_cast<float>(std::sin(beam)), -static_cast<float>(std::cos(beam)));
      CHECK(metadata.sensor.column_of(row, azimuth_rad - 1e-6) == column);
      const double offset_s = (measured - 255.5) / 512.0 * 0.05;
      CHECK(scan.cloud.time_offset_s[pixel] == doctest::Approx(offset_s).scale(0).epsilon(1e-4));
    }
  }
  CHECK(scan.stamp_s == doctest::Approx(1.6e9 + 5.15 + 0.05 * 255.5 / 512).scale(0).epsilon(1e-15));
}

TEST_CASE("lost packets are counted and leave empty columns; doubled and late ones are left out") {
  const OusterProfile profile = OusterProfile::kRng15;
  auto packets = ouster_turns(profile, {10, 11, 12, 15});
  packets.erase(packets.begin() + 32 + 4);            // of turn 11: columns 64 to 79
  packets.insert(packets.begin() + 40, packets[38]);  // doubled
  packets.insert(packets.begin() + 70, packets[1]);   // of turn 10, in turn 12
  packets.push_back({packets[0].time_ns, 7502, Payload(100)});
  OusterDecoder decoder(small_metadata(profile));
  const auto frames = decoded(decoder, packets);
  REQUIRE(frames.size() == 4);
  CHECK(decoder.counts().lost == 1);
  CHECK(decoder.counts().late == 2);
  CHECK(decoder.counts().foreign == 1);
  CHECK(decoder.lost_scans() == 2);
  for (std::size_t column = 0; column < 512; ++column) {
    CHECK((frames[1].range_mm[column] == 0) == (column >= 64 && column < 80));
    CHECK(frames[2].range_mm[column] > 0);
  }
}

TEST_CASE("a window that begins within a packet: a packet that comes twice counts once") {
  const OusterProfile profile = OusterProfile::kRng15;
  const std::string text = replaced_in(ouster_metadata_text(profile), "[0, 511]", "[100, 355]");
  const OusterMetadata metadata = ouster_metadata_from_json(text, "a test");
  constexpr std::size_t kColumnBytes = 12 + 4 * 8;
  std::vector<Captured> packets;
  for (Captured packet : ouster_turns(profile, {1, 2, 3})) {
    bool sent = false;
    for (std::size_t i = 0; i < 16; ++i) {
      const std::size_t at = 32 + kColumnBytes * i;
      const auto column = little_endian<std::uint16_t>(packet.payload, at + 8);
      if (column >= 100 && column <= 355) {
        sent = true;
      } else {  // not measured: no time and no status
        put(packet.payload, at, std::uint64_t{0});
        put(packet.payload, at + 10, std::uint16_t{0});
      }
    }
    if (!sent) continue;
    packets.push_back(packet);
    packets.push_back(packet);
  }
  OusterDecoder decoder(metadata);
  const auto frames = decoded(decoder, packets);
  REQUIRE(frames.size() == 3);
  CHECK(decoder.counts().used == 3 * 17);
  CHECK(decoder.counts().late == 3 * 17);
  CHECK(decoder.counts().lost == 0);
  OusterGeometry geometry(metadata);
  for (std::size_t turn = 0; turn < 3; ++turn) {
    for (std::size_t column = 0; column < 512; ++column) {
      CHECK((frames[turn].status[column] != 0) == (column >= 100 && column <= 355));
    }
    // The first packet was captured when column 96 was measured, and tells the time of column 100.
    const double middle = 96 + (355 - 100) / 2.0;
    CHECK(geometry.scan(frames[turn])->stamp_s ==
          doctest::Approx(1600000005.05 + 0.05 * (static_cast<double>(turn) + middle / 512))
              .scale(0)
              .epsilon(1e-15));
  }
}

TEST_CASE("turns that the recording cuts off are left out unless nothing else is there") {
  const OusterProfile profile = OusterProfile::kLegacy;
  auto packets = ouster_turns(profile, {1, 2, 3});
  packets.erase(packets.begin(), packets.begin() + 10);
  packets.resize(packets.size() - 10);
  OusterDecoder decoder(small_metadata(profile));
  const auto frames = decoded(decoder, packets);
  REQUIRE(frames.size() == 1);
  CHECK(frames[0].frame_id == 2);
  CHECK(decoder.partial_scans() == 2);

  auto one = ouster_turns(profile, {1});
  one.erase(one.begin(), one.begin() + 10);
  OusterDecoder other(small_metadata(profile));
  CHECK(decoded(other, one).size() == 1);
  CHECK(other.counts().lost == 10);
}

TEST_CASE("of two returns the strongest is kept, or the farther one on request") {
  const OusterMetadata metadata = small_metadata(OusterProfile::kRng19Dual);
  OusterDecoder decoder(metadata);
  const auto frames = decoded(decoder, ouster_turns(OusterProfile::kRng19Dual, {1}));
  OusterGeometry strongest(metadata);
  OusterGeometry last(metadata, {.kept_return = KeptReturn::kLast});
  const float near_m = strongest.scan(frames[0])->cloud.range_m[0];
  const float far_m = last.scan(frames[0])->cloud.range_m[0];
  CHECK(far_m - near_m == doctest::Approx(0.5).scale(0).epsilon(0.01));
}

TEST_CASE("metadata that are not an Ouster's, or of a profile that is not known, are refused") {
  const std::string text = ouster_metadata_text(OusterProfile::kRng15);
  const auto refuses = [&](const std::string& from, const std::string& to, const auto&... parts) {
    const std::string json = replaced_in(text, from, to);
    CHECK(refused_with([&] { ouster_metadata_from_json(json, "beside.json"); }, parts...));
  };
  refuses("RNG15_RFL8_NIR8", "RNG99", "beside.json", "udp_profile_lidar", "RNG99",
          "RNG19_RFL8_SIG16_NIR16_DUAL");
  refuses("[0, 511]", "[0, 512]", "column_window", "0 to 511");
  refuses("\"columns_per_packet\": 16", "\"columns_per_packet\": 0", "columns_per_packet",
          "1 to 64");
  refuses(text, sensor_json(sensor_preset("vlp-16")), "Ouster");
  CHECK_NOTHROW(ouster_metadata_from_json(text, "beside.json"));
}

TEST_CASE("a text that nests deeper than any metadata is not taken for an Ouster's") {
  const auto nested = [](std::size_t levels) {
    return "{\"beam_intrinsics\": " + std::string(levels, '[') + std::string(levels, ']') + "}";
  };
  CHECK(is_ouster_metadata(nested(20)));
  CHECK_FALSE(is_ouster_metadata(nested(40)));
}

TEST_CASE("real Ouster frames have every value that Ouster's own decoder reads") {
  // Digests of values whose MD5 digests are those that Ouster's decoder comes with.
  for (const auto& [name, frame, digest] :
       {std::tuple("packets/ouster/OS-0-128-U1_v2.3.0_1024x10", 1491U,
                   std::uint64_t{2255424449135168262}),
        std::tuple("packets/ouster/OS-0-32-U1_v2.2.0_1024x10", 1453U,
                   std::uint64_t{11331563746950871072U})}) {
    const auto path = real_data(name);
    if (!path) return;
    CAPTURE(*path);
    OusterDecoder decoder(read_ouster_metadata(*path + ".json"));
    const auto packets = open_pcap(*path + ".pcap");
    while (const auto packet = packets->next()) decoder.add(*packet);
    decoder.finish();
    const std::vector<OusterFrame> frames = decoder.take_scans();
    REQUIRE(frames.size() == 1);
    const OusterFrame& of_it = frames[0];
    CHECK(of_it.frame_id == frame);
    std::uint64_t found = hash_of(of_it.timestamp_ns);
    for (const auto* values : {&of_it.status, &of_it.range_mm, &of_it.second_range_mm}) {
      found = hash_of(*values, found);
    }
    for (const auto* values : {&of_it.reflectivity, &of_it.second_reflectivity}) {
      found = hash_of(*values, found);
    }
    CHECK(found == digest);
    CHECK(decoder.counts().lost == 0);
  }
}
