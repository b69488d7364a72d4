#include "bags.h"
#include "files/scan_files.h"
#include "near.h"
#include "packets/ouster_decoder.h"

using namespace hqslam::recordings;

namespace {

constexpr OusterProfile kProfile = OusterProfile::kRng19;

/// Turns 2 to 5, 50 ms each, and inertial data every 10 ms by the same clock, from when turn 2
/// begins on. Both come 2 ms after they were measured.
std::vector<Captured> turns_with_imu(std::uint16_t imu_port = 7503) {
  constexpr std::int64_t kLatency_ns = 2'000'000;
  std::vector<Captured> packets = ouster_turns(kProfile, {2, 3, 4, 5});
  const std::int64_t begin_ns = 5'000'000'000 + 2 * 50'000'000;
  for (std::int64_t time_ns = begin_ns; time_ns < begin_ns + 200'000'000; time_ns += 10'000'000) {
    packets.push_back({1'600'000'000'000'000'000 + time_ns, imu_port, ouster_imu_packet(time_ns)});
  }
  for (Captured& packet : packets) packet.time_ns += kLatency_ns;
  std::ranges::stable_sort(packets, {}, &Captured::time_ns);
  return packets;
}

std::string ouster_capture(const TemporaryDirectory& folder, const std::vector<Captured>& packets) {
  write_file(folder.file("a.pcap"), pcap_bytes(packets));
  write_file(folder.file("a.json"), ouster_metadata_text(kProfile));
  return folder.file("a.pcap");
}

}  // namespace

TEST_CASE("an Ouster's inertial packet says what Ouster's own decoder reads, in our units") {
  // The values that ouster-sdk 1.0.1 reads, in g and degrees a second, where byte i is 7 i + 40
  // modulo 128.
  Payload packet(kOusterImuBytes);
  for (std::size_t i = 0; i < packet.size(); ++i) {
    packet[i] = static_cast<std::uint8_t>((7 * i + 40) % 128);
  }
  const ImuSample sample = ouster_imu_sample(
      packet, ouster_metadata_from_json(ouster_metadata_text(kProfile), "a test"));
  CHECK(sample.stamp_s == doctest::Approx(5278846808.513453848).epsilon(1e-15));
  CHECK(sample.specific_force_mps2.x() == doctest::Approx(6.562349940868731e+22 * 9.80665));
  CHECK(sample.specific_force_mps2.z() == doctest::Approx(0.0));
  const double degree_rad = std::numbers::pi / 180.0;
  CHECK(sample.angular_rate_rad_per_s.y() == doctest::Approx(14175338233856.0 * degree_rad));
  CHECK(sample.angular_rate_rad_per_s.z() == doctest::Approx(1.1606337665928483e+30 * degree_rad));
}

TEST_CASE("inertial data are turned into the frame of the scans by the metadata's transforms") {
  const auto R_of = [](const std::string& more_fields) {
    const std::string text = ouster_metadata_text(kProfile);
    const std::string with = replaced_in(text, "\"prod_sn\"", more_fields + ", \"prod_sn\"");
    return ouster_metadata_from_json(with, "a test").R_sensor_imu;
  };
  const std::string usual =
      R"("lidar_to_sensor_transform": [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36, 0, 0, 0, 1])";
  const Eigen::Vector3d force(1.0, 2.0, 3.0);
  CHECK(near(R_of(usual) * force, force));
  // A quarter turn to the left.
  const std::string turned =
      R"("imu_to_sensor_transform": [0, -1, 0, 6, 1, 0, 0, -11, 0, 0, 1, 7, 0, 0, 0, 1])";
  CHECK(near(R_of(turned) * force, {-2.0, 1.0, 3.0}));
  CHECK(near(R_of(R"("imu_intrinsics": {)" + turned + "}") * force, {-2.0, 1.0, 3.0}));
  // Our scans keep to the lidar frame, wherever the sensor frame looks.
  CHECK(near(
      R_of(R"("lidar_to_sensor_transform": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])") *
          force,
      {-1.0, -2.0, 3.0}));
  CHECK(refused_with([&] { R_of(R"("imu_to_sensor_transform": [1, 2])"); }, "imu_to_sensor", "16"));
  CHECK(
      refused_with([&] { R_of(replaced_in(usual, "[-1", "[-2")); }, "lidar_to_sensor", "rotation"));
}

TEST_CASE("a scan of an Ouster's capture carries the inertial data up to its end, by its clock") {
  const TemporaryDirectory folder;
  const auto scans = all_scans(Recording::open(ouster_capture(folder, turns_with_imu())));
  REQUIRE(scans.size() == 4);
  std::vector<ImuSample> samples;
  for (const RecordedScan& scan : scans) {
    CAPTURE(scan.name);
    REQUIRE(scan.imu.size() == 5);
    for (std::size_t i = 0; i < 5; ++i) {
      const double since_middle_s = scan.imu[i].stamp_s - scan.stamp_s;
      CHECK(std::abs(since_middle_s - (-0.025 + 0.01 * static_cast<double>(i))) < 1e-4);
      CHECK(near(scan.imu[i].specific_force_mps2, kGravity_mps2 * Eigen::Vector3d(0.25, 0.0, 1.0)));
      CHECK(near(scan.imu[i].angular_rate_rad_per_s, {0.0, 0.0, std::numbers::pi / 2.0}));
    }
  }
  const RecordingInfo info = inspect(folder.file("a.pcap"));
  CHECK(info.imu_stream == "192.168.1.201:7503");
  CHECK(info.imu.used == 20);
  CHECK(info.imu.left_out == 0);
  CHECK(info.imu_rate_hz == doctest::Approx(100.0).epsilon(1e-3));
  CHECK(info.packets.foreign == 0);
  CHECK(info.warnings.empty());
}

TEST_CASE("scans are the same with inertial data beside them, on the lidar's port or without") {
  const TemporaryDirectory folder;
  auto lidar_only = turns_with_imu();
  std::erase_if(lidar_only, [](const Captured& packet) { return packet.port == 7503; });
  const auto expected = all_scans(Recording::open(ouster_capture(folder, lidar_only)));
  CHECK(inspect(folder.file("a.pcap")).imu_stream.empty());
  for (const std::uint16_t port : {std::uint16_t{7503}, std::uint16_t{7502}}) {
    const auto scans = all_scans(Recording::open(ouster_capture(folder, turns_with_imu(port))));
    REQUIRE(same_scans(scans, expected));
    for (std::size_t i = 0; i < scans.size(); ++i) {
      CHECK(expected[i].imu.empty());
      CHECK(scans[i].imu.size() == 5);
    }
  }
}

TEST_CASE("inertial data of another sender are not the Ouster's, those of the nearer port are") {
  const TemporaryDirectory folder;
  auto packets = turns_with_imu();
  for (Captured packet : turns_with_imu(7510)) {
    if (packet.port == 7510) packets.push_back(std::move(packet));
  }
  std::ranges::stable_sort(packets, {}, &Captured::time_ns);
  CHECK(inspect(ouster_capture(folder, packets)).imu_stream == "192.168.1.201:7503");
  for (Captured& packet : packets) packet.sender = packet.port == 7502 ? 201 : 202;
  CHECK(inspect(ouster_capture(folder, packets)).imu_stream.empty());
}

TEST_CASE("inertial data that are not finite, not in order or of another time are left out") {
  const TemporaryDirectory folder;
  auto packets = turns_with_imu();
  std::vector<Captured*> imu;
  for (Captured& packet : packets) {
    if (packet.port == 7503) imu.push_back(&packet);
  }
  put(imu[3]->payload, 28, std::bit_cast<std::uint32_t>(std::numeric_limits<float>::quiet_NaN()));
  imu[8]->payload = imu[7]->payload;                  // twice
  put(imu[12]->payload, 16, std::uint64_t{7});        // the clock was set back,
  put(imu[13]->payload, 16, ~std::uint64_t{0} - 40);  // and forward
  imu[16]->payload.pop_back();
  auto source = Recording::open(ouster_capture(folder, packets));
  const auto scans = all_scans(source);
  REQUIRE(scans.size() == 4);
  std::size_t samples = 0;
  for (const RecordedScan& scan : scans) {
    samples += scan.imu.size();
    for (const ImuSample& sample : scan.imu) {
      CHECK(std::abs(sample.stamp_s - scan.stamp_s) < 0.1);
      CHECK(sample.specific_force_mps2.allFinite());
    }
  }
  CHECK(samples == 15);
  CHECK(source.info().imu.used == 15);
  CHECK(source.info().imu.left_out == 4);
  CHECK(one_line_with(source.warnings(), "4 inertial samples were left out"));
}

TEST_CASE("inertial samples that wait for a scan which never comes take no more memory") {
  ImuQueue queue;
  for (int i = 0; i < 100'000; ++i) queue.add({.stamp_s = 1e-4 * i});
  CHECK(queue.counts().used == 20'000);
  CHECK(queue.counts().left_out == 80'000);
  CHECK(queue.take(9.0, 100.0).size() == 10'001);
  CHECK(queue.take(10.0, 100.0).size() == 9'999);
  CHECK(queue.take(10.0, 100.0).empty());
}

TEST_CASE("an inertial profile of new firmware is named as not read") {
  const TemporaryDirectory folder;
  ouster_capture(folder, turns_with_imu());
  write_file(folder.file("a.json"),
             replaced_in(ouster_metadata_text(kProfile), "\"udp_profile_lidar\"",
                         R"("udp_profile_imu": "ACCEL32_GYRO32_NMEA", "udp_profile_lidar")"));
  const auto warnings = Recording::open(folder.file("a.pcap")).warnings();
  CHECK(one_line_with(warnings, "ACCEL32_GYRO32_NMEA are not read"));
}

TEST_CASE("an Ouster's inertial packets are found in a bag beside its lidar packets") {
  const TemporaryDirectory folder;
  for (const bool ros1 : {false, true}) {
    std::vector<BagMessage> messages = {{"/ouster/metadata", "std_msgs/msg/String", 1,
                                         text_message(ouster_metadata_text(kProfile), ros1)}};
    for (const Captured& packet : turns_with_imu()) {
      messages.push_back({packet.port == 7502 ? "/ouster/lidar_packets" : "/ouster/imu_packets",
                          "ouster_ros/msg/PacketMsg", packet.time_ns,
                          buffer_message(packet.payload, ros1)});
    }
    const std::string path = folder.file(ros1 ? "a.bag" : "a.mcap");
    write_file(path, ros1 ? ros1_bytes(messages, "lz4") : mcap_bytes(messages, "zstd"));
    if (!ros1) write_db3(messages, folder.file("a.db3"));
    for (const std::string& name : {path, folder.file("a.db3")}) {
      const auto scans = all_scans(Recording::open(name));
      REQUIRE(scans.size() == 4);
      for (const RecordedScan& scan : scans) CHECK(scan.imu.size() == 5);
      CHECK(inspect(name).imu_stream == "/ouster/imu_packets");
    }
  }
}

TEST_CASE("inertial data that are given win over the recording's own") {
  const TemporaryDirectory folder;
  const std::string path = ouster_capture(folder, turns_with_imu());
  ImuSample given;
  given.stamp_s = all_scans(Recording::open(path))[2].stamp_s;
  const auto scans =
      all_scans(*with_imu(std::make_unique<Recording>(Recording::open(path)), {given}));
  for (std::size_t i = 0; i < scans.size(); ++i) CHECK(scans[i].imu.size() == (i == 2 ? 1 : 0));
}
