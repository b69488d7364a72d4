#include "captures.h"
#include "hqslam/core/angles.h"
#include "hqslam/recordings/recording.h"
#include "packets/robosense_decoder.h"

using namespace hqslam::recordings;

namespace {

RobosenseDecoder decoder_of(const Robosense& sensor, const DecoderOptions& options = {}) {
  const RobosenseUnit unit = robosense_unit(robosense_settings(sensor), sensor.helios, "a test");
  return {unit, unit.sensor, options};
}

double clockwise_deg(const Eigen::Vector3f& point_m) {
  return std::atan2(-point_m.y(), point_m.x()) / kDegree_rad;
}

}  // namespace

TEST_CASE("points and times of a RoboSense's packets are those that its manuals describe") {
  for (const Robosense& sensor :
       {Robosense{false, 16, false}, Robosense{false, 16, true}, Robosense{true, 16, false},
        Robosense{true, 32, false, 2000}, Robosense{true, 32, true, 2000}}) {
    CAPTURE(sensor.helios);
    CAPTURE(sensor.lasers);
    CAPTURE(sensor.dual);
    const auto lasers = static_cast<std::size_t>(sensor.lasers);
    const double firing_us = sensor.helios ? 55.56 : 55.5;
    const double channel_us = sensor.helios ? 1.73 : 2.8;
    const double range_m = sensor.distance * (sensor.helios ? 0.0025 : 0.005);
    RobosenseDecoder decoder = decoder_of(sensor);
    const std::vector<Captured> packets = robosense_capture(sensor, 0.3);
    const std::vector<Scan> scans = decoded(decoder, packets);
    REQUIRE(scans.size() == 3);  // from the azimuth 0 on; what is left is nearly a turn
    CHECK(decoder.partial_scans() == 1);
    CHECK(decoder.counts().foreign == 1);  // the settings
    CHECK(decoder.counts().used == static_cast<std::int64_t>(packets.size()) - 1);
    CHECK(decoder.counts().lost == 0);
    const Scan& scan = scans[1];
    CHECK(std::abs(static_cast<double>(scan.points_m.size()) -
                   static_cast<double>(lasers) * 1e5 / firing_us) < 2.0 * sensor.lasers);
    CHECK(scan.intensity == std::vector<float>(scan.points_m.size(), 10.0F));
    // The first channel of an RS-16 looks lowest, of this Helios highest.
    const double first_deg = sensor.helios ? 15.0 : -15.0;
    CHECK(scan.row[0] == (sensor.helios ? 0 : 15));
    CHECK(scan.row[1] == (sensor.helios ? 1 : 14));
    const double level_m =
        range_m * std::cos(15.0 * kDegree_rad) + (sensor.helios ? 0.03498 : 0.03825);
    CHECK(scan.points_m[0].head<2>().norm() == doctest::Approx(level_m));
    CHECK(scan.points_m[0].z() == doctest::Approx(range_m * std::sin(first_deg * kDegree_rad)));
    // Azimuths advance by 3.6 degrees in a millisecond, clockwise from the front.
    const double begin_deg = clockwise_deg(scan.points_m[0]);
    CHECK(begin_deg > -0.011);
    CHECK(begin_deg < 0.21);
    for (const std::size_t firing : {1U, 2U, 9U, 400U}) {
      const double expected_deg = begin_deg + 3.6e-3 * firing_us * static_cast<double>(firing);
      CHECK(std::abs(clockwise_deg(scan.points_m[firing * lasers]) - expected_deg) < 0.02);
      CHECK(scan.time_offset_s[firing * lasers] - scan.time_offset_s[0] ==
            doctest::Approx(1e-6 * firing_us * static_cast<double>(firing)).epsilon(0.02));
    }
    CHECK(scan.time_offset_s[1] - scan.time_offset_s[0] ==
          doctest::Approx(1e-6 * channel_us).epsilon(0.02));
    if (!sensor.helios) {
      CHECK(std::abs(clockwise_deg(scan.points_m[8]) - begin_deg - 3.6e-3 * 8 * channel_us) < 0.02);
    } else {
      CHECK(clockwise_deg(scan.points_m[1]) - begin_deg == doctest::Approx(1.0).epsilon(0.03));
    }
    // The head passes the front 100/6 ms after the first firing.
    CHECK(std::abs(scans[0].stamp_s + double{scans[0].time_offset_s[0]} - 1'600'000'000.0 -
                   1.0 / 60.0) < 1e-4);
  }
}

TEST_CASE("of two returns of a RoboSense's pulse the asked one is kept") {
  for (const int lasers : {16, 32}) {
    for (const auto& [kept, range_m] :
         {std::pair(KeptReturn::kStrongest, 3.0F), std::pair(KeptReturn::kLast, 4.0F)}) {
      const Robosense sensor = {true, lasers, true};
      std::vector<Captured> packets = robosense_capture(sensor, 0.15);
      Payload& packet = packets[60].payload;
      set_robosense_measurement(packet, 0, 3, 1600, 5);
      set_robosense_measurement(packet, lasers == 16 ? 0 : 1, lasers == 16 ? 19 : 3, 1200, 50);
      RobosenseDecoder decoder = decoder_of(sensor, {.kept_return = kept});
      const std::vector<Scan> scans = decoded(decoder, packets);
      REQUIRE(scans.size() == 1);
      const auto count = [&](float wanted_m) {
        return std::ranges::count_if(scans[0].points_m, [&](const Eigen::Vector3f& point_m) {
          return std::abs(point_m.norm() - wanted_m - 0.034F) < 0.003F;
        });
      };
      CHECK(count(range_m) == 1);
      CHECK(count(7.0F - range_m) == 0);
    }
  }
}

TEST_CASE("RoboSense packets that are damaged, late or lost are counted") {
  const Robosense sensor;
  std::vector<Captured> packets = robosense_capture(sensor, 0.25);
  packets[10].payload.pop_back();
  packets[11].payload[42] = 0;   // a block's beginning
  packets[12].payload[21] = 13;  // a month
  std::swap(packets[20], packets[21]);
  packets.erase(packets.begin() + 30, packets.begin() + 33);
  RobosenseDecoder decoder = decoder_of(sensor);
  CHECK(decoded(decoder, packets).size() == 2);
  CHECK(decoder.counts().foreign == 1 + 3);
  CHECK(decoder.counts().late == 1);
  CHECK(decoder.counts().lost == 3 + 1 + 3);  // the late one too
}

TEST_CASE("a capture of a RoboSense is read with the settings that it has, or refused") {
  const TemporaryDirectory folder;
  const std::string capture = folder.file("a.pcap");
  const Robosense helios = {true, 32, false};
  const std::vector<Captured> packets = robosense_capture(helios, 0.35);
  write_file(capture, pcap_bytes(packets));
  auto source = Recording::open(capture);
  CHECK(source.sensor().name == "helios");
  CHECK(source.sensor().rows() == 32);
  CHECK(source.sensor().columns == 1800);
  CHECK(source.sensor().beam_elevation_rad[31] == doctest::Approx(-16.0 * kDegree_rad));
  CHECK(source.sensor().beam_azimuth_offset_rad[31] == doctest::Approx(-1.0 * kDegree_rad));
  CHECK(all_scans(source).size() == 3);
  CHECK(inspect(capture).format == "RoboSense Helios packets, 32 beams, single return");
  CHECK(refused_with([&] { Recording::open(capture, {.sensor = "vlp-16"}); }, "16 rows", "32"));
  CHECK(Recording::open(capture, {.sensor = "hdl-32e"}).warnings().size() == 1);

  write_file(capture, pcap_bytes({packets.begin() + 1, packets.end()}));
  CHECK(refused_with([&] { Recording::open(capture); }, "DIFOP", "7788"));
  std::vector<Captured> of_ten = packets;
  of_ten[0].payload[468 + 30] = 0xFF;  // the eleventh beam
  write_file(capture, pcap_bytes(of_ten));
  CHECK(refused_with([&] { Recording::open(capture); }, "10 beams", "16 or 32"));
  std::vector<Captured> rs16 = robosense_capture({}, 0.15);
  std::fill(rs16[0].payload.begin() + 1165, rs16[0].payload.begin() + 1213, std::uint8_t{0});
  write_file(capture, pcap_bytes(rs16));
  CHECK(refused_with([&] { Recording::open(capture); }, "16 or 32", "angles"));
}
