#include "bags.h"
#include "hqslam/core/angles.h"
#include "hqslam/recordings/recording.h"
#include "packets/hesai_decoder.h"

using namespace hqslam::recordings;

namespace {

std::string angle_file(int lasers, double lift_deg = 0.0, double aside_deg = 0.0) {
  std::string text = "Channel,Elevation,Azimuth\r\n";
  for (int i = 0; i < lasers; ++i) {
    text +=
        fmt::format("{},{:.6f},{:.6f}\r\n", i + 1, 15.0 + lift_deg - i * 32.0 / lasers, aside_deg);
  }
  return text;
}

}  // namespace

TEST_CASE("points and times of a Hesai's packets are those that the manual's formulas give") {
  for (const int lasers : {16, 32}) {
    CAPTURE(lasers);
    SensorModel sensor = nominal_hesai(lasers);
    sensor.beam_azimuth_offset_rad[1] -= 1.0 * kDegree_rad;  // one degree clockwise
    HesaiDecoder decoder(sensor);
    std::vector<Captured> packets = hesai_capture(lasers, 0.3);
    const std::vector<Scan> scans = decoded(decoder, packets);
    REQUIRE(scans.size() == 3);  // from the azimuth 0 on; what is left is nearly a turn
    const Scan& scan = scans[0];
    // The first firing of a turn, at the azimuth 0.12: nearly y of the maker's frame.
    CHECK(scan.points_m.size() == 2000 * static_cast<std::size_t>(lasers));
    CHECK(std::atan2(scan.points_m[0].x(), scan.points_m[0].y()) ==
          doctest::Approx(0.12 * kDegree_rad));
    CHECK(scan.points_m[0].y() == doctest::Approx(5.0 * std::cos(15.0 * kDegree_rad)));
    CHECK(scan.points_m[0].z() == doctest::Approx(5.0 * std::sin(15.0 * kDegree_rad)));
    const Eigen::Vector3f& second_m = scan.points_m[1];
    CHECK(std::atan2(second_m.x(), second_m.y()) == doctest::Approx(1.12 * kDegree_rad));
    CHECK(scan.row[1] == 1);
    CHECK(scan.intensity == std::vector<float>(scan.points_m.size(), 10.0F));
    // A quarter of a turn later it looks along x.
    const Eigen::Vector3f& later_m = scan.points_m[500 * static_cast<std::size_t>(lasers)];
    CHECK(later_m.x() == doctest::Approx(5.0 * std::cos(15.0 * kDegree_rad)));
    CHECK(scan.time_offset_s[1] - scan.time_offset_s[0] ==
          doctest::Approx(lasers == 16 ? 3.024e-6 : 1.512e-6).epsilon(0.02));
    CHECK(scan.time_offset_s[static_cast<std::size_t>(lasers)] - scan.time_offset_s[0] ==
          doctest::Approx(50e-6).epsilon(0.002));
    // Turn 0 begins 60 degrees after the first firing, 333 firings of 50 us; the packet's time is
    // 6 us before its last firing.
    const double first_s = 1'600'000'000.0 - 350e-6 + 6e-6 + 334 * 50e-6;
    CHECK(scan.stamp_s + double{scan.time_offset_s[0]} ==
          doctest::Approx(first_s).scale(0).epsilon(1e-14));
    CHECK(decoder.counts().used == static_cast<std::int64_t>(packets.size()));
    CHECK(decoder.counts().lost == 0);
    CHECK(decoder.partial_scans() == 1);
  }
}

TEST_CASE("each firing of a Hesai has a column of its own, at the azimuth of the laser") {
  // As real ones fire: at multiples of 0.18 degrees.
  std::vector<Captured> packets;
  for (int i = 0; i < 251; ++i) {
    packets.push_back({1'600'000'000'000'000'000 + 400'000LL * i, 2368,
                       hesai_packet_bytes(16, static_cast<std::uint32_t>(400 * i),
                                          18 * 8 * i % 36000, static_cast<std::uint32_t>(i))});
  }
  HesaiDecoder decoder(nominal_hesai(16));
  for (const Captured& packet : packets) decoder.add(as_packet(packet));
  decoder.finish();
  const auto scan = decoder.next().value();
  CHECK(std::ranges::count(scan.cloud.range_m, 0.0F) == 0);
  const SensorModel& sensor = decoder.sensor();
  for (const int column : {0, 7, 1999}) {
    const Eigen::Vector3f& point_m = scan.cloud.points_m[scan.cloud.index(3, column)];
    const double apart_rad = std::atan2(point_m.y(), point_m.x()) - sensor.azimuth_rad(3, column);
    CHECK(std::abs(std::remainder(apart_rad, 2.0 * M_PI)) < 1e-5);
  }
}

TEST_CASE("of two returns of a Hesai's pulse the asked one is kept, whatever their order") {
  for (const bool last_first : {true, false}) {
    for (const auto& [kept, distance] :
         {std::pair(KeptReturn::kStrongest, 1000), std::pair(KeptReturn::kLast, 2000)}) {
      std::vector<Captured> packets = hesai_capture(16, 0.15, last_first ? 0x39 : 0x3C);
      set_hesai_measurement(packets[100].payload, 16, last_first ? 0 : 1, 3, 2000, 5);
      set_hesai_measurement(packets[100].payload, 16, last_first ? 1 : 0, 3, 1000, 50);
      set_hesai_measurement(packets[100].payload, 16, 0, 4, 0);
      HesaiDecoder decoder(nominal_hesai(16), {.kept_return = kept});
      const std::vector<Scan> scans = decoded(decoder, packets);
      REQUIRE(scans.size() == 1);
      const float range_m = 0.004F * static_cast<float>(distance);
      const auto of_it = std::ranges::count_if(scans[0].points_m, [&](const auto& point_m) {
        return std::abs(point_m.norm() - range_m) < 0.001F;
      });
      CHECK(of_it == 1);
      CHECK(scans[0].points_m.size() == 2000 * 16);  // of the missing return the other one
    }
  }
}

TEST_CASE("Hesai packets that are damaged, late, lost or another's are counted") {
  std::vector<Captured> packets = hesai_capture(32, 0.25);
  packets[10].payload.pop_back();
  packets[11].payload[6] = 64;
  packets[12].payload = hesai_packet_bytes(16, 1, 0, 12);
  packets[13].payload[packets[13].payload.size() - 28 + 14] = 13;  // a month
  std::swap(packets[20], packets[21]);
  packets.erase(packets.begin() + 30, packets.begin() + 33);
  HesaiDecoder decoder(nominal_hesai(32));
  CHECK(decoded(decoder, packets).size() == 2);
  CHECK(decoder.counts().foreign == 4);
  CHECK(decoder.counts().late == 1);
  CHECK(decoder.counts().lost == 4 + 1 + 3);  // the late one too, as its number was missing

  HesaiDecoder after_gap(nominal_hesai(32));
  packets = hesai_capture(32, 0.8);
  packets.erase(packets.begin() + 500, packets.begin() + 1500);  // four turns
  CHECK(decoded(after_gap, packets).size() == 4);
  CHECK(after_gap.lost_scans() == 3);
}

TEST_CASE("a capture and a bag of Hesai packets give the same scans, by the angle file beside") {
  const TemporaryDirectory folder;
  const auto packets = hesai_capture(16, 0.35, 0x39);
  write_file(folder.file("a.pcap"), pcap_bytes(packets));
  write_file(folder.file("a_angles.csv"), angle_file(16, 0.25, 0.5));
  write_db3(scan_messages("/pandar_packets", "pandar_msgs/msg/PandarScan", packets, 10, false,
                          pandar_scan_message),
            folder.file("b.db3"));
  write_file(folder.file("b.csv"), angle_file(16, 0.25, 0.5));

  auto source = Recording::open(folder.file("a.pcap"));
  CHECK(source.sensor().name == "xt16");
  CHECK(source.sensor().columns == 2000);
  CHECK(source.sensor().beam_elevation_rad[0] == doctest::Approx(15.25 * kDegree_rad));
  CHECK(source.sensor().beam_azimuth_offset_rad[0] == doctest::Approx((0.09 - 0.5) * kDegree_rad));
  const auto scans = all_scans(source);
  REQUIRE(scans.size() == 3);
  CHECK(source.warnings().empty());
  CHECK(same_scans(all_scans(Recording::open(folder.file("b.db3"))), scans));
  CHECK(inspect(folder.file("a.pcap")).format == "Hesai XT16 packets, dual return");
}

TEST_CASE("without a fitting angle file the manual's serve, with a warning; a wrong one fails") {
  const Capture made(hesai_capture(32, 0.15));
  const std::string& capture = made.path;
  auto source = Recording::open(capture);
  CHECK(source.sensor() == nominal_hesai(32));
  CHECK(one_line_with(source.warnings(), ".csv"));

  const std::string angles = made.folder.file("angles.csv");
  write_file(angles, angle_file(32));
  CHECK(Recording::open(capture, {.sensor = angles}).warnings().empty());
  CHECK(refused_with([&] { Recording::open(capture, {.sensor = "vlp-16"}); }, "32 rows", "vlp-16"));
  const auto other = Recording::open(capture, {.sensor = "hdl-32e"}).warnings();
  CHECK(one_line_with(other, "sensor 'hdl-32e', up to 14.7 degrees beside xt32's"));
  const std::string good = angle_file(32);
  for (const std::string& wrong :
       {angle_file(16), good.substr(0, good.size() / 2), std::string("Channel\n"), std::string(),
        good + "33,-17,0\n", std::string("1,nan,0\n"), std::string("1,15,0\n1,14,0\n"),
        std::string("1,15,0\n2,16,0\n"), std::string("1,1e99,0\n")}) {
    write_file(angles, wrong);
    CHECK(refused_with([&] { Recording::open(capture, {.sensor = angles}); }, "angle"));
  }
}
