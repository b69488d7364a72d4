#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "captures.h"
#include "error_message.h"
#include "file_contents.h"
#include "hqslam/core/angles.h"
#include "hqslam/recordings/recording.h"
#include "lslidar_decoder.h"
#include "temporary_directory.h"

using namespace hqslam;
using namespace hqslam::recordings;
using namespace hqslam::test;

namespace {

LslidarDecoder decoder_of(const Lslidar& sensor, const TurnDecoderOptions& options = {}) {
  const LslidarPacket said = {sensor.v4, kLslidarC16, sensor.dual};
  LslidarUnit unit = lslidar_unit(lslidar_settings(sensor), said, "a test");
  unit.fraction_ns = static_cast<int>(1000 / sensor.fraction_of_us);
  return {unit, unit.sensor, options};
}

/// Degrees, of a channel: from below, every other one of the upper half.
double elevation_deg(const Lslidar& sensor, int channel) {
  const double lowest = sensor.v4 ? -16.0 : -15.2;
  return lowest + 2.0 * (channel / 2) + (channel % 2 == 1 ? 16.0 : 0.0);
}

}  // namespace

TEST_CASE("points and times of an LSLiDAR C16's packets are those that its manual describes") {
  for (const Lslidar& sensor :
       {Lslidar{}, Lslidar{.dual = true}, Lslidar{.v4 = true}, Lslidar{.v4 = true, .dual = true}}) {
    CAPTURE(sensor.v4);
    CAPTURE(sensor.dual);
    LslidarDecoder decoder = decoder_of(sensor);
    const std::vector<Captured> packets = lslidar_capture(sensor, 0.3);
    const std::vector<Scan> scans = decoded(decoder, packets);
    REQUIRE(scans.size() == 3);
    CHECK(decoder.counts().foreign == 1);  // the settings
    CHECK(decoder.counts().lost == 0);
    const Scan& scan = scans[1];
    CHECK(scan.points_m.size() == 32'000);  // 2000 firings
    const double range_m = sensor.distance * (sensor.v4 ? 0.004 : 0.0025);
    const double lens_m = sensor.v4 ? 0.0361 : 0.0431;
    const double behind_rad = (sensor.v4 ? 20.25 : 14.68) * kDegree_rad;
    // The head passes the front in block 166, at 359.94 degrees its second firing; the next block
    // is at 0.12. The first packet was recorded when it ended.
    const double begin_s = scan.time_offset_s[0];
    const double first_s = 0.999 - (sensor.dual ? 596.875e-6 : 1196.875e-6) + 0.0167;
    CHECK(std::abs(scan.stamp_s + begin_s - 1.6e9 - first_s - 0.1) < 2e-6);
    for (const int i : {0, 1, 14, 15, 16, 33, 1000, 20'007}) {
      CAPTURE(i);
      const double later_us = 50.0 * (i / 16) + 3.125 * (i % 16);
      CHECK(std::abs(scan.time_offset_s[i] - begin_s - 1e-6 * later_us) < 3e-7);
      const double elevation_rad = elevation_deg(sensor, i % 16) * kDegree_rad;
      const double azimuth_rad = (0.12 + 3.6e-3 * later_us) * kDegree_rad;
      const double level_m = range_m * std::cos(elevation_rad);
      const double lens_rad = azimuth_rad - behind_rad;
      const Eigen::Vector3d expected_m(
          level_m * std::cos(azimuth_rad) + lens_m * std::cos(lens_rad),
          -level_m * std::sin(azimuth_rad) - lens_m * std::sin(lens_rad),
          range_m * std::sin(elevation_rad));
      CHECK((scan.points_m[i].cast<double>() - expected_m).norm() < 1e-4);
      CHECK(scan.row[i] == (i % 2 == 0 ? 15 : 7) - i % 16 / 2);
      CHECK(scan.intensity[i] == 10.0F);
    }
  }
}

TEST_CASE("a wall before an LSLiDAR C16 is where it stands, seen in turning") {
  constexpr double kWall_m = 8.0;
  for (const Lslidar& sensor : {Lslidar{.distance = 0}, Lslidar{.v4 = true, .distance = 0}}) {
    const double unit_m = sensor.v4 ? 0.004 : 0.0025;
    const double lens_m = sensor.v4 ? 0.0361 : 0.0431;
    const double behind_rad = (sensor.v4 ? 20.25 : 14.68) * kDegree_rad;
    std::vector<Captured> packets = lslidar_capture(sensor, 0.15);
    for (std::size_t i = 1; i < packets.size(); ++i) {
      for (int j = 0; j < 12 * 32; ++j) {
        const double time_us = 1200.0 * static_cast<double>(i - 1) + 3.125 * j;
        const double azimuth_rad = (300.0 + 3.6e-3 * time_us) * kDegree_rad;
        if (std::cos(azimuth_rad) < 0.5) continue;
        const double ahead =
            std::cos(azimuth_rad) * std::cos(elevation_deg(sensor, j % 16) * kDegree_rad);
        const double range_m = (kWall_m - lens_m * std::cos(azimuth_rad - behind_rad)) / ahead;
        set_measurement(packets[i].payload, j / 32, j % 32,
                        static_cast<std::uint16_t>(std::lround(range_m / unit_m)));
      }
    }
    LslidarDecoder decoder = decoder_of(sensor);
    const std::vector<Scan> scans = decoded(decoder, packets);
    REQUIRE(scans.size() == 1);
    CHECK(scans[0].points_m.size() > 5000);  // 60 of 120 degrees are in the next turn
    for (const Eigen::Vector3f& point_m : scans[0].points_m) {
      REQUIRE(std::abs(point_m.x() - kWall_m) < unit_m);
    }
  }
}

TEST_CASE("of two returns of an LSLiDAR's pulse the asked one is kept") {
  const Lslidar sensor = {.dual = true};
  std::vector<Captured> packets = lslidar_capture(sensor, 0.15);
  set_measurement(packets[60].payload, 2, 21, 1600, 50);
  set_measurement(packets[60].payload, 3, 21, 1700, 5);
  for (const auto& [kept, range_m] :
       {std::pair(KeptReturn::kStrongest, 4.0F), std::pair(KeptReturn::kLast, 4.25F)}) {
    LslidarDecoder decoder = decoder_of(sensor, {.kept_return = kept});
    const std::vector<Scan> scans = decoded(decoder, packets);
    REQUIRE(scans.size() == 1);
    CHECK(std::ranges::count_if(scans[0].points_m,
                                [range_m = range_m](const Eigen::Vector3f& point_m) {
                                  return std::abs(point_m.norm() - range_m) < 0.05F;
                                }) == 1);
  }
}

TEST_CASE("an LSLiDAR's times go on where its clock begins anew, of whichever kind it is") {
  for (const Lslidar& sensor :
       {Lslidar{}, Lslidar{.end_us = 3'599'950'000, .cycle_us = 3'600'000'000},
        Lslidar{.v4 = true, .fraction_of_us = 1}, Lslidar{.v4 = true, .ptp = true},
        Lslidar{.v4 = true, .fraction_of_us = 1, .ptp = true}}) {
    std::vector<Captured> packets = lslidar_capture(sensor, 4.25);
    packets.erase(packets.begin() + 100, packets.begin() + 2600);  // three seconds, or 30 turns
    LslidarDecoder decoder = decoder_of(sensor);
    CHECK(decoded(decoder, packets).size() == 12);
    CHECK(decoder.counts().late == 0);
    CHECK(decoder.lost_scans() == 29);
  }
}

TEST_CASE("LSLiDAR packets that are damaged, late, of another kind or lost are counted") {
  for (const bool v4 : {false, true}) {
    std::vector<Captured> packets = lslidar_capture({.v4 = v4}, 0.25);
    packets[10].payload.pop_back();
    packets[11].payload[300] = 0;                                // a block's mark
    packets[12].payload[403] = 0xFF;                             // an azimuth
    packets[13].payload.back() = 0x20;                           // a C32
    packets[14].payload[packets[14].payload.size() - 2] = 0x39;  // two returns
    packets[15].payload[v4 ? 1201 : 1203] = 0xFF;                // a month; hours
    std::swap(packets[20], packets[21]);
    packets.erase(packets.begin() + 30, packets.begin() + 33);
    LslidarDecoder decoder = decoder_of({.v4 = v4});
    CHECK(decoded(decoder, packets).size() == 2);
    CHECK(decoder.counts().foreign == 1 + 6);
    CHECK(decoder.counts().late == 1);
    CHECK(decoder.counts().lost == 6 + 1 + 3);
  }
}

TEST_CASE("a capture of an LSLiDAR C16 is read with the settings that it has, or refused") {
  const TemporaryDirectory folder;
  const std::string capture = folder.file("a.pcap");
  const auto write = [&](const std::vector<Captured>& packets) {
    write_file(capture, pcap_bytes(packets));
  };
  const auto refused = [&](const char* expected, const char* found) {
    return refused_with([&] { open_recording(capture); }, expected, found);
  };
  for (const Lslidar& sensor :
       {Lslidar{.dual = true}, Lslidar{.v4 = true}, Lslidar{.v4 = true, .fraction_of_us = 1}}) {
    const std::vector<Captured> packets = lslidar_capture(sensor, 0.35);
    write(packets);
    const auto source = open_recording(capture);
    CHECK(source->sensor().rows() == 16);
    CHECK(source->sensor().columns == 2000);
    CHECK(source->sensor().beam_elevation_rad[0] ==
          doctest::Approx((sensor.v4 ? 14.0 : 14.8) * kDegree_rad));
    CHECK(all_scans(*source).size() == 3);
    write({packets.begin() + 1, packets.end()});
    CHECK(refused("DIFOP", "2369"));
    std::vector<Captured> other = packets;
    other[0].payload[1196] = 0x01;
    other[0].payload[1198] = 0x01;
    write(other);
    CHECK(refused("version 2.8 or 3", "unit of distances"));
    other = packets;
    for (Captured& packet : other) packet.payload.back() = 0x20;
    write(other);
    CHECK(refused("C16", "model 20"));
  }
  std::vector<Captured> packets = lslidar_capture({}, 0.15);
  CHECK((write(packets), inspect(capture).format) ==
        "LSLiDAR C16 packets, 16 beams, single return");
  std::fill_n(packets[0].payload.begin() + 245, 32, std::uint8_t{0});
  write(packets);
  CHECK(refused("2 or 1.33 degrees", "name a sensor"));
  CHECK(open_recording(capture, {.sensor = "vlp-16"})->sensor().name == "vlp-16");
}
