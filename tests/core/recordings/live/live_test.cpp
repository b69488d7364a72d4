#include "hqslam/live/live.h"

#include "hqslam/recordings/recording.h"
#include "loopback.h"
#include "udp_socket.h"

using namespace hqslam::live;
using namespace hqslam::recordings;

namespace {

/// Whose scans wait for a test that a busy computer holds up.
LiveOptions vlp16() { return {.sensor = "vlp-16", .port = free_udp_port(), .most_waiting = 50}; }

/// Of a small Ouster, whose metadata are in the folder.
LiveOptions ouster(const TemporaryDirectory& folder, OusterProfile profile) {
  write_file(folder.file("sensor.json"), ouster_metadata_text(profile));
  return {.sensor = folder.file("sensor.json"), .port = free_udp_port()};
}

void send_turn(const LoopbackSender& sender, OusterProfile profile, std::uint32_t frame_id) {
  for (const Captured& packet : ouster_turn(profile, frame_id)) sender.send(packet.payload);
}

/// Waits until it is recognized, and begins to decode what it sends.
void start(LiveSensor& sensor) {
  REQUIRE(sensor.recognize(kPatience_s));
  sensor.start();
}

/// All scans that come until `sent` packets are through, and none comes any more.
std::vector<LiveScan> all_scans(LiveSensor& sensor, std::int64_t expected) {
  std::vector<LiveScan> scans;
  while (static_cast<std::int64_t>(scans.size()) < expected) {
    auto scan = sensor.next(kPatience_s);
    if (!scan) break;
    scans.push_back(std::move(*scan));
  }
  return scans;
}

/// Sends packets no faster than they are taken in, however slow the computer is.
void replay_in_step(const std::vector<Captured>& packets, std::uint16_t port,
                    const LiveSensor& sensor) {
  constexpr std::size_t kAtOnce = 32;
  const LoopbackSender sender(port);
  const auto taken_in = [&] {
    const PacketCounts counts = sensor.counts().packets;
    return counts.used + counts.late + counts.foreign;
  };
  for (std::size_t begin = 0; begin < packets.size(); begin += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, packets.size() - begin);
    const std::int64_t wanted = taken_in() + static_cast<std::int64_t>(count);
    for (std::size_t i = 0; i < count; ++i) sender.send(packets[begin + i].payload);
    wait_until([&] { return taken_in() >= wanted; });
  }
}

}  // namespace

TEST_CASE("scans that come over UDP are those of the capture with the same packets") {
  const auto packets = velodyne_capture({.duration_s = 1.5});
  const Capture capture(packets);
  auto recorded = Recording::open(capture.path);
  const LiveOptions options = vlp16();
  LiveSensor sensor(options);
  const std::jthread sending([&] { replay(packets, options.port, 1.0); });
  REQUIRE(sensor.recognize(kPatience_s));
  CHECK(sensor.sensor() == recorded.sensor());
  CHECK(sensor.format() == "Velodyne packets, single return");
  CHECK(text(sensor.sender()) == fmt::format("127.0.0.1:{}", options.port));
  sensor.start();
  // Half a second of 1.5 s was for recognizing; what is left has eight or nine whole turns.
  const auto scans = all_scans(sensor, 8);
  REQUIRE(scans.size() == 8);
  for (const LiveScan& scan : scans) {
    std::optional<RecordedScan> same = recorded.next();
    while (same && same->cloud.range_m != scan.scan.cloud.range_m) same = recorded.next();
    CHECK(same);  // in the same order
    CHECK(scan.completed_ns > 1'700'000'000'000'000'000);
    // Its stamp is by this computer's clock, in the middle of the turn before it was complete.
    const double age_s = 1e-9 * static_cast<double>(scan.completed_ns) - scan.scan.stamp_s;
    CHECK(age_s == doctest::Approx(0.05).epsilon(0.4));
  }
  for (std::size_t i = 1; i < scans.size(); ++i) {
    CHECK(scans[i].scan.stamp_s - scans[i - 1].scan.stamp_s == doctest::Approx(0.1).epsilon(0.02));
  }
  CHECK(sensor.counts().packets.lost == 0);
  CHECK(sensor.counts().dropped_scans == 0);
}

TEST_CASE("memory does not grow with what was received, whether scans are taken or not") {
  const auto resident_kb = [] {
    std::istringstream status(file_contents("/proc/self/statm"));
    std::int64_t total = 0;
    std::int64_t resident = 0;
    status >> total >> resident;
    return 4 * resident;
  };
  LiveOptions options = vlp16();
  options.most_waiting = 2;
  LiveSensor sensor(options);
  {
    const std::jthread sending(
        [&] { replay(velodyne_capture({.duration_s = 2.0}), options.port, 0.0); });
    REQUIRE(sensor.recognize(kPatience_s));
  }
  sensor.start();
  const auto packets = velodyne_capture({.duration_s = 10.0});
  replay_in_step(packets, options.port, sensor);
  const std::int64_t before_kb = resident_kb();
  for (int round = 0; round < 4; ++round) {
    replay_in_step(packets, options.port, sensor);
    while (round % 2 == 0 && sensor.next(0.05)) continue;
  }
  CHECK(sensor.counts().scans > 350);
#ifndef __SANITIZE_ADDRESS__                // which keeps what was freed for a while
  CHECK(resident_kb() - before_kb < 4000);  // 400 scans would be 180 MB
#endif
}

TEST_CASE("an Ouster's turn is complete with its last packet, whatever its metadata came by") {
  const TemporaryDirectory folder;
  const OusterProfile profile = OusterProfile::kRng19;
  LiveOptions options = ouster(folder, profile);
  options.record = folder.file("kept.pcap");
  LiveSensor sensor(options);
  const LoopbackSender sender(options.port);
  sender.send(Payload(48));  // inertial data
  sender.send(ouster_turn(profile, 7)[0].payload);
  REQUIRE(sensor.recognize(kPatience_s));
  CHECK(sensor.sensor().rows() == 8);
  CHECK(sensor.format() == "Ouster packets, RNG19_RFL8_SIG16_NIR16");
  sensor.start();
  send_turn(sender, profile, 8);
  REQUIRE(sensor.next(kPatience_s));                   // what came of turn 7
  const auto scan = sensor.next(kPatience_s).value();  // no packet of turn 9 was sent
  CHECK(scan.scan.counts.kept + scan.scan.counts.out_of_range == 8 * 512);
  sender.send(ouster_turn(profile, 8)[3].payload);  // comes twice, behind the end of its turn
  send_turn(sender, profile, 10);
  REQUIRE(sensor.next(kPatience_s));
  CHECK(sensor.counts().packets.late == 1);
  CHECK(sensor.counts().lost_scans == 1);
  CHECK(file_contents(folder.file("kept.json")) == ouster_metadata_text(profile));
}

TEST_CASE("a port in use, an unknown sensor and packets of another one are refused in one line") {
  LiveOptions options = vlp16();
  const UdpSocket other(options.port);
  CHECK(refused_with([&] { LiveSensor sensor(options); }, fmt::format("UDP port {}", options.port),
                     "uses it"));
  options = vlp16();
  options.sensor = "hdl-64e";
  CHECK(refused_with([&] { LiveSensor sensor(options); }, "hdl-64e", "calibration of that unit"));
  options.sensor = "vlp-17";
  CHECK(refused_with([&] { LiveSensor sensor(options); }, "vlp-17"));
}

TEST_CASE("packets of another sensor are named while waiting, and the sensor is found after them") {
  const LiveOptions options = vlp16();
  LiveSensor sensor(options);
  CHECK(sensor.complaint().empty());
  const LoopbackSender stranger(options.port, 2);
  for (int i = 0; i < 300; ++i) stranger.send(Payload(900));
  CHECK_FALSE(sensor.recognize(0.3));
  CHECK(one_line_with(sensor.complaint(), "900 bytes", "127.0.0.2", "vlp-16"));
  const std::jthread sending(
      [&] { replay(velodyne_capture({.duration_s = 0.7}), options.port, 1.0); });
  CHECK(sensor.recognize(kPatience_s));
  CHECK(text(sensor.sender()) == fmt::format("127.0.0.1:{}", options.port));
}

TEST_CASE("a stranger's packet that looks like the sensor's does not make its sender the sensor") {
  const TemporaryDirectory folder;
  const auto packets = velodyne_capture({.duration_s = 1.2});
  LiveOptions options = vlp16();
  options.record = folder.file("kept.pcap");
  {
    LiveSensor sensor(options);
    const LoopbackSender stranger(options.port, 2);
    stranger.send(packets[100].payload);
    const std::jthread sending([&] { replay(packets, options.port, 1.0); });
    REQUIRE(sensor.recognize(kPatience_s));
    CHECK(text(sensor.sender()) == fmt::format("127.0.0.1:{}", options.port));
    sensor.start();
    stranger.send(packets[200].payload);
    REQUIRE(all_scans(sensor, 5).size() == 5);
    CHECK(sensor.counts().other_senders == 1);
    CHECK(sensor.counts().packets.lost == 0);
  }
  const RecordingInfo info = inspect(options.record);  // the sensor's packets, from its first on
  CHECK(info.streams.size() == 1);
  CHECK(info.packets.used > 800);
}

TEST_CASE("a sensor whose address changes is followed once it sends from the new one alone") {
  const auto packets = velodyne_capture({.duration_s = 4.5});
  const auto part = [&](double begin_s, double end_s) {
    const auto at = [&](double s) {
      return packets.begin() +
             static_cast<std::ptrdiff_t>(s / 4.5 * static_cast<double>(packets.size()));
    };
    return std::vector<Captured>(at(begin_s), at(end_s));
  };
  const LiveOptions options = vlp16();
  LiveSensor sensor(options);
  const std::jthread sending([&] {
    replay(part(0.0, 1.2), options.port, 1.0);
    replay(part(1.2, 4.5), options.port, 1.0, 3);
  });
  start(sensor);
  // From 0.5 s to 1.2 s, then from where it was silent for a second on.
  CHECK(all_scans(sensor, 20).size() == 20);
  CHECK(sensor.counts().senders_changed == 1);
  CHECK(sensor.counts().lost_scans > 5);
  CHECK(text(sensor.sender()) == fmt::format("127.0.0.3:{}", options.port));
}

TEST_CASE("a sensor that starts again in the drive is followed on, however it counts then") {
  {
    const auto packets = velodyne_capture({.duration_s = 1.2});  // its clock begins anew, too
    const LiveOptions options = vlp16();
    LiveSensor sensor(options);
    const std::jthread sending([&] {
      replay(packets, options.port, 1.0);
      replay(packets, options.port, 1.0);
    });
    start(sensor);
    const auto scans = all_scans(sensor, 16);
    REQUIRE(scans.size() == 16);
    for (std::size_t i = 1; i < scans.size(); ++i) {
      CHECK(scans[i].scan.stamp_s > scans[i - 1].scan.stamp_s);
    }
    CHECK(sensor.counts().packets.late == 0);
    CHECK(sensor.counts().packets.lost == 0);
    CHECK(sensor.counts().trouble.empty());
  }
  const TemporaryDirectory folder;
  LiveOptions options = ouster(folder, OusterProfile::kRng19);
  options.most_waiting = 5;
  LiveSensor sensor(options);
  const LoopbackSender sender(options.port);
  send_turn(sender, OusterProfile::kRng19, 5000);
  start(sensor);
  for (const std::uint32_t frame_id : {5001, 0, 1, 2}) {
    send_turn(sender, OusterProfile::kRng19, frame_id);
  }
  CHECK(all_scans(sensor, 5).size() == 5);
  CHECK(sensor.counts().lost_scans == 0);
  CHECK(sensor.counts().packets.late == 0);
}

TEST_CASE("a sensor that falls silent, or is set to another mode in the drive, is said to") {
  const auto packets = velodyne_capture({.duration_s = 1.0});
  const LiveOptions options = vlp16();
  LiveSensor sensor(options);
  {
    const std::jthread sending([&] { replay(packets, options.port, 1.0); });
    start(sensor);
  }
  CHECK(sensor.counts().trouble.empty());
  wait_until([&] { return !sensor.counts().trouble.empty(); });
  CHECK(one_line_with(sensor.counts().trouble, "no more packets", "cable"));
  replay(packets, options.port, 1.0);
  wait_until([&] { return sensor.counts().trouble.empty(); });
  const LoopbackSender sender(options.port);
  wait_until([&] {
    sender.send(Payload(1300));
    return !sensor.counts().trouble.empty();
  });
  CHECK(one_line_with(sensor.counts().trouble, "another form", "mode"));
}
