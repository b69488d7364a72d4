#include "captures.h"
#include "hqslam/core/angles.h"
#include "hqslam/recordings/recording.h"
#include "packets/velodyne_decoder.h"

using namespace hqslam::recordings;

namespace {

VelodyneStream probed(const std::vector<Captured>& packets) {
  VelodyneProbe probe;
  for (const Captured& captured : packets) probe.add(as_packet(captured));
  return probe.result().value();
}

struct Decoded {
  std::vector<Scan> scans;
  PacketCounts counts;
  std::int64_t partial = 0;
  std::int64_t lost = 0;  ///< turns
};

Decoded decoded(const std::vector<Captured>& packets, const VelodyneStream& stream,
                const DecoderOptions& options = {}) {
  VelodyneDecoder decoder(stream, sensor_preset(name(stream.model)), options);
  std::vector<Scan> scans = decoded(decoder, packets);
  return {std::move(scans), decoder.counts(), decoder.partial_scans(), decoder.lost_scans()};
}

/// From the first point to the last.
double duration_s(const Scan& scan) {
  const auto [first, last] = std::ranges::minmax_element(scan.time_offset_s);
  return *last - *first;
}

/// Sets the sensor's clock on from the packet `begin` on, and maybe the capture's.
void set_on(std::vector<Captured>& packets, std::size_t begin, std::int64_t later_us,
            std::int64_t captured_later_us = 0) {
  for (std::size_t i = begin; i < packets.size(); ++i) {
    const auto time_us = little_endian<std::uint32_t>(packets[i].payload, kTimeAt);
    put(packets[i].payload, kTimeAt,
        static_cast<std::uint32_t>((time_us + later_us) % 3'600'000'000));
    packets[i].time_ns += 1000 * captured_later_us;
  }
}

}  // namespace

TEST_CASE("the lasers of every model are the beams of its preset") {
  for (const VelodyneModel model : kVelodyneModels) {
    CAPTURE(name(model));
    const SensorModel sensor = sensor_preset(name(model));
    const auto elevations_deg = laser_elevations_deg(model);
    const auto rows = laser_rows(model);
    REQUIRE(static_cast<int>(elevations_deg.size()) == sensor.rows());
    std::vector<bool> used(rows.size(), false);
    for (std::size_t laser = 0; laser < rows.size(); ++laser) {
      used[rows[laser]] = true;
      CHECK(std::abs(radians(elevations_deg[laser]) - sensor.beam_elevation_rad[rows[laser]]) <
            radians(0.02));
    }
    CHECK(std::ranges::count(used, false) == 0);
  }
  // The eight columns of a VLS-128's lasers: -6.354 degrees for lasers 0, 8, 16, ...
  const SensorModel vls = sensor_preset("vls-128");
  const double column_deg[] = {-6.354, -4.548, -2.732, -0.911, 0.911, 2.732, 4.548, 6.354};
  const auto rows = laser_rows(VelodyneModel::kVls128);
  for (std::size_t laser = 0; laser < 128; ++laser) {
    CHECK(vls.beam_azimuth_offset_rad[rows[laser]] ==
          doctest::Approx(radians(column_deg[laser % 8])));
  }
}

TEST_CASE("the spacing of the packets tells the model, whatever the factory byte says") {
  for (const auto& [model, firing_us] : {std::pair{VelodyneModel::kVlp16, 110.592},
                                         {VelodyneModel::kHdl32e, 46.08},
                                         {VelodyneModel::kVlp32c, 55.296}}) {
    for (const bool dual : {false, true}) {
      const VelodyneStream stream = probed(
          velodyne_capture({.firing_us = firing_us, .dual = dual, .product = 0x21}));  // HDL-32E
      CHECK(stream.model == model);
      CHECK(stream.dual_return == dual);
      CHECK(stream.factory_model == VelodyneModel::kHdl32e);
      CHECK(stream.scan_period_s == doctest::Approx(0.1).scale(0).epsilon(0.001));
      CHECK(stream.field_of_view_deg == 360.0);
    }
  }
}

TEST_CASE("packets of an HDL-64E and of an LSLiDAR, which look alike, are refused") {
  std::vector<Captured> packets = velodyne_capture();
  for (Captured& packet : packets) {
    for (std::size_t block = 1; block < 12; block += 2) {
      put(packet.payload, 100 * block, std::uint16_t{0xDDFF});
    }
  }
  const Capture hdl_64e(packets);
  CHECK(refused_with([&] { Recording::open(hdl_64e.path); }, "HDL-64E", "point clouds"));
  const Capture other(velodyne_capture({.product = 0x10}));
  CHECK(refused_with([&] { Recording::open(other.path); }, other.path));
}

TEST_CASE("a Puck Hi-Res is refused without its beams, and an unknown factory byte is named") {
  const TemporaryDirectory folder;
  const std::string path = folder.file("a.pcap");
  write_file(path, pcap_bytes(velodyne_capture({.product = 0x24})));
  CHECK(refused_with([&] { Recording::open(path); }, path, "Puck Hi-Res", "sensor file"));
  SensorModel own = sensor_preset("vlp-16");
  for (double& elevation_rad : own.beam_elevation_rad) elevation_rad *= 2.0 / 3.0;
  write_sensor_json(own, folder.file("own.json"));
  CHECK(Recording::open(path, {.sensor = folder.file("own.json")}).warnings().empty());
  for (const auto& [byte, warnings] : {std::pair(0x22, 0), std::pair(0x7F, 1)}) {
    write_file(path, pcap_bytes(velodyne_capture({.product = static_cast<std::uint8_t>(byte)})));
    const std::vector<std::string> found = Recording::open(path).warnings();
    REQUIRE(std::ssize(found) == warnings);
    if (warnings == 1) CHECK(found[0].find("0x7f") != std::string::npos);
  }
}

TEST_CASE("turns of any rate and field of view become scans with the recording's stamps") {
  for (const double rate_hz : {5.0, 10.0, 17.0, 20.0}) {
    for (const bool blind : {false, true}) {
      CAPTURE(rate_hz);
      CAPTURE(blind);
      RoundRoom room{.rate_hz = rate_hz, .duration_s = 4.5 / rate_hz};
      if (blind) {  // looks to the front: 280 to 80 degrees
        room.blind_from_deg = 80.0;
        room.blind_to_deg = 280.0;
      }
      const auto packets = velodyne_capture(room);
      const VelodyneStream stream = probed(packets);
      CHECK(stream.scan_period_s == doctest::Approx(1.0 / rate_hz).scale(0).epsilon(0.002));
      CHECK(stream.field_of_view_deg ==
            doctest::Approx(blind ? 160.0 : 360.0).scale(0).epsilon(0.02));
      const Decoded d = decoded(packets, stream);
      CHECK(d.counts.lost == 0);
      // The head looks away first where there is a blind angle: three quarters are soon together.
      REQUIRE(d.scans.size() == (blind ? 5 : 4));
      for (std::size_t i = 0; i < d.scans.size(); ++i) {
        const Scan& scan = d.scans[i];
        if (i > 0) {
          CHECK(scan.stamp_s - d.scans[i - 1].stamp_s ==
                doctest::Approx(1.0 / rate_hz)
                    .scale(0)
                    .epsilon(i == 1 || i + 1 == d.scans.size() ? 0.1 : 0.02));
        }
        const auto [first, last] = std::ranges::minmax_element(scan.time_offset_s);
        CHECK(*last - *first < 1.02 * (blind ? 160.0 / 360.0 : 1.0) / rate_hz);
        CHECK(std::abs(*last + *first) < 0.002);
      }
    }
  }
}

TEST_CASE("lost, doubled, overtaken and foreign packets are counted, and a lost turn is a gap") {
  auto packets = velodyne_capture({.duration_s = 1.05});
  packets.erase(packets.begin() + 200, packets.begin() + 290);  // more than a turn
  packets.insert(packets.begin() + 100, packets[98]);           // doubled
  std::swap(packets[50], packets[51]);                          // overtaken
  packets.push_back({packets.back().time_ns, 8308, Payload(512)});
  const Decoded d = decoded(packets, probed(packets));
  CHECK(d.counts.lost == 90 + 1);
  CHECK(d.counts.late == 2);
  CHECK(d.counts.foreign == 1);
  double longest_s = 0.0;
  for (std::size_t i = 1; i < d.scans.size(); ++i) {
    longest_s = std::max(longest_s, d.scans[i].stamp_s - d.scans[i - 1].stamp_s);
  }
  CHECK(longest_s > 0.14);
}

TEST_CASE("packets and turns of an outage are counted, however long it lasts") {
  using Outage = std::pair<double, double>;
  for (const auto& [outage_s, turns] : {Outage{0.25, 2}, Outage{1, 10}, Outage{2.55, 25},
                                        Outage{1900, 19000}, Outage{10805, 108050}}) {
    CAPTURE(outage_s);
    auto packets = velodyne_capture({.duration_s = 1.05, .first_azimuth_deg = 0.0});
    const VelodyneStream stream = probed(packets);
    const auto later_us = static_cast<std::int64_t>(1e6 * outage_s);
    set_on(packets, 400, later_us, later_us);
    const Decoded d = decoded(packets, stream);
    const double expected = 1e6 * outage_s / 1327.104;
    CHECK(std::abs(static_cast<double>(d.counts.lost) - expected) < 1.0 + 1e-3 * expected);
    CHECK(std::abs(static_cast<double>(d.lost) - turns) <= 1.0 + 1e-3 * turns);
    CHECK(d.scans.back().stamp_s - d.scans.front().stamp_s > outage_s);
  }
}

TEST_CASE("no scan lasts longer than a turn, however many packets were lost") {
  // 75.4 packets a turn: up to just less than a turn, to just more, 1.1 and 1.9 turns are missing.
  for (const int lost : {74, 75, 82, 142}) {
    CAPTURE(lost);
    auto packets = velodyne_capture({.duration_s = 0.95});
    const VelodyneStream stream = probed(packets);
    packets.erase(packets.begin() + 184, packets.begin() + 184 + lost);  // from 100 degrees on
    const Decoded d = decoded(packets, stream);
    CHECK(d.counts.lost == lost);
    REQUIRE(d.scans.size() >= 5);
    for (const Scan& scan : d.scans) CHECK(duration_s(scan) < 1.01 * stream.scan_period_s);
  }
}

TEST_CASE("a gap of nearly a turn, which leaves the azimuth as it was, ends a scan") {
  std::vector<Captured> packets;
  const auto add = [&](double time_ms) {
    const int azimuth = static_cast<int>(std::lround(360.0 * time_ms)) % 36000;
    packets.push_back({std::llround(1e6 * time_ms), 2368,
                       velodyne_packet(static_cast<std::uint32_t>(std::lround(1e3 * time_ms)),
                                       std::vector(12, azimuth))});
  };
  for (int i = 0; i <= 13; ++i) add(10.0 * i);         // up to 108 degrees of the second turn
  for (int i = 0; i < 20; ++i) add(229.5 + 10.0 * i);  // from 106.2 degrees of the third turn on
  const Decoded d = decoded(packets, VelodyneStream{});
  REQUIRE(d.scans.size() == 2);
  CHECK(duration_s(d.scans[0]) == doctest::Approx(0.09).epsilon(0.02));
  CHECK(duration_s(d.scans[1]) == doctest::Approx(0.09).epsilon(0.02));
  CHECK(d.partial == 3);
}

TEST_CASE("time goes on over the hour, and a clock that is set ends a scan") {
  auto packets = velodyne_capture({.duration_s = 0.5});
  set_on(packets, 0, 3'599'800'000);
  const Decoded over_hour = decoded(packets, probed(packets));
  REQUIRE(over_hour.scans.size() == 5);
  CHECK(over_hour.counts.lost == 0);
  CHECK(over_hour.scans[3].stamp_s - over_hour.scans[0].stamp_s ==
        doctest::Approx(0.3).scale(0).epsilon(0.01));
  set_on(packets, 150, 400'000'000);
  // Set in the third turn: what was before and behind it are two parts, the first one nearly whole.
  const Decoded set = decoded(packets, probed(packets));
  REQUIRE(set.scans.size() == 5);
  CHECK(over_hour.partial == 1);
  CHECK(set.partial == 2);
  for (std::size_t i = 2; i < 5; ++i) {
    CHECK(std::abs(set.scans[i].stamp_s - over_hour.scans[i].stamp_s) < 0.001);
  }
  auto both_set_back = velodyne_capture({.duration_s = 0.5});  // the capture's clock too
  set_on(both_set_back, 150, 3'595'000'000, -5'000'000);
  const Decoded back = decoded(both_set_back, probed(both_set_back));
  CHECK(back.partial == 2);
  for (const Scan& scan : back.scans) CHECK(duration_s(scan) < 0.11);
}
