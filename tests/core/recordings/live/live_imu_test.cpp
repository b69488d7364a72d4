#include "hqslam/live/live.h"
#include "hqslam/recordings/recording.h"
#include "loopback.h"
#include "udp_socket.h"

using namespace hqslam::live;
using namespace hqslam::recordings;

namespace {

constexpr OusterProfile kProfile = OusterProfile::kRng19;

/// An Ouster whose metadata name a port for inertial data.
struct Fixture {
  TemporaryDirectory folder;
  std::uint16_t imu_port = free_udp_port();
  LiveOptions options{.sensor = folder.file("sensor.json"), .port = free_udp_port()};

  Fixture() {
    std::string text = ouster_metadata_text(kProfile);
    text.insert(1, fmt::format("\"udp_port_imu\": {}, ", imu_port));
    write_file(options.sensor, text);
  }

  void recognize(LiveSensor& sensor) const {
    LoopbackSender(options.port).send(ouster_turn(kProfile, 2)[0].payload);
    REQUIRE(sensor.recognize(kPatience_s));
    sensor.start();
  }
  /// A turn, and what was measured when it began.
  void send_turn(std::uint32_t id) const {
    LoopbackSender(imu_port).send(ouster_imu_packet(5'000'000'000 + id * 50'000'000LL));
    for (const Captured& packet : ouster_turn(kProfile, id)) {
      LoopbackSender(options.port).send(packet.payload);
    }
  }
};

}  // namespace

TEST_CASE("inertial data that come over UDP come with their scan, and are recorded with it") {
  Fixture fixture;
  fixture.options.record = fixture.folder.file("kept.pcap");
  {
    LiveSensor sensor(fixture.options);
    fixture.recognize(sensor);
    LoopbackSender(fixture.imu_port).send(Payload(47));
    LoopbackSender(fixture.imu_port, 9).send(ouster_imu_packet(5'000'000'000));  // a stranger's
    fixture.send_turn(3);
    REQUIRE(sensor.next(kPatience_s));  // what came of turn 2
    const auto scan = sensor.next(kPatience_s).value();
    REQUIRE(scan.scan.imu.size() == 1);
    CHECK(std::abs(scan.scan.imu[0].stamp_s - scan.scan.stamp_s + 0.025) < 1e-3);
    CHECK(scan.scan.imu[0].specific_force_mps2.z() == doctest::Approx(kGravity_mps2));
    CHECK(sensor.counts().imu.used == 1);
    CHECK(sensor.counts().imu_failure.empty());
  }
  const RecordingInfo info = inspect(fixture.folder.file("kept.pcap"));
  CHECK(info.imu_stream == fmt::format("127.0.0.1:{}", fixture.imu_port));
  CHECK(info.imu.used == 1);
}

TEST_CASE("inertial data of a scan that is dropped come with the next one") {
  Fixture fixture;
  fixture.options.most_waiting = 1;
  LiveSensor sensor(fixture.options);
  fixture.recognize(sensor);
  for (std::uint32_t id = 3; id < 8; ++id) fixture.send_turn(id);
  wait_until([&] { return sensor.counts().scans >= 6; });
  const auto scan = sensor.next(kPatience_s).value();
  CHECK(sensor.counts().dropped_scans == 5);
  REQUIRE(scan.scan.imu.size() == 5);
  for (std::size_t i = 1; i < 5; ++i) {
    CHECK(scan.scan.imu[i].stamp_s > scan.scan.imu[i - 1].stamp_s);
  }
}

TEST_CASE("a port of inertial data that is in use is said, and scans come all the same") {
  const Fixture fixture;
  const UdpSocket other(fixture.imu_port);
  LiveSensor sensor(fixture.options);
  fixture.recognize(sensor);
  CHECK(sensor.counts().imu_failure.find(std::to_string(fixture.imu_port)) != std::string::npos);
  fixture.send_turn(3);
  REQUIRE(sensor.next(kPatience_s));
  CHECK(sensor.next(kPatience_s)->scan.imu.empty());
}
