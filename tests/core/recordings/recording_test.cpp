#include "hqslam/recordings/recording.h"

#include "bags.h"
#include "core/real_data.h"
#include "made_images.h"

using namespace hqslam::recordings;

TEST_CASE("the stamps of a capture whose computer's clock was set back rise, with a warning") {
  std::vector<Captured> packets = velodyne_capture({.duration_s = 0.85});
  for (std::size_t i = packets.size() / 2; i < packets.size(); ++i) {
    packets[i].time_ns -= 5'000'000'000;
  }
  const Capture capture(packets);
  auto source = Recording::open(capture.path);
  const auto scans = all_scans(source);
  REQUIRE(scans.size() >= 6);
  for (std::size_t i = 1; i < scans.size(); ++i) {
    CHECK(scans[i].stamp_s > scans[i - 1].stamp_s);
    CHECK(scans[i].stamp_s < scans[i - 1].stamp_s + 0.25);
  }
  CHECK(one_line_with(source.warnings(), "stamps repeat or fall back"));
}

TEST_CASE("a file with the name of a capture or a bag and other contents is refused for these") {
  const TemporaryDirectory directory;
  for (const char* name : {"a.pcap", "a.pcapng", "a.db3", "a.mcap", "a.bag"}) {
    const std::string path = directory.file(name);
    for (const auto& [contents, found] :
         {std::pair("", "found an empty file"), std::pair("junk", "found a file that begins")}) {
      write_file(path, contents);
      CHECK(refused_with([&] { Recording::open(path); }, path, found));
      CHECK(refused_with([&] { inspect(path); }, path, found));
    }
  }
  write_file(directory.file("a.xyz"), "junk");
  CHECK(refused_with([&] { Recording::open(directory.file("a.xyz")); }, "'.xyz'", ".pcap", ".bag"));
  write_file(directory.file("a.osf"), "junk");
  CHECK(refused_with([&] { Recording::open(directory.file("a.osf")); }, "Ouster's .osf", "save"));
}

namespace {

/// What this program has asked the system to read up to now.
std::int64_t bytes_read() {
  std::istringstream io(file_contents("/proc/self/io"));
  std::string name;
  std::int64_t bytes = 0;
  io >> name >> bytes;
  REQUIRE(name == "rchar:");
  return bytes;
}

}  // namespace

TEST_CASE("a recording is read once, from opening it to its last scan, and so it is by inspect") {
  const TemporaryDirectory directory;
  const auto packets = velodyne_capture({.duration_s = 30.0});
  write_file(directory.file("a.pcap"), pcap_bytes(packets));
  const auto messages =
      scan_messages("/velodyne_packets", "velodyne_msgs/msg/VelodyneScan", packets, 76, false);
  write_db3(messages, directory.file("a.db3"));
  write_file(directory.file("a.mcap"), mcap_bytes(messages, ""));
  for (const char* name : {"a.pcap", "a.db3", "a.mcap"}) {
    CAPTURE(name);
    const auto most = static_cast<std::int64_t>(
        1.1 * static_cast<double>(std::filesystem::file_size(directory.file(name))));
    std::int64_t before = bytes_read();
    auto source = Recording::open(directory.file(name));
    CHECK_FALSE(source.size());
    source.use_columns(900);
    double share = 0.0;
    std::int64_t scans = 0;
    while (const auto scan = source.next()) {
      CHECK(scan->cloud.columns == 900);
      CHECK(source.read_share() >= share);
      share = source.read_share();
      ++scans;
    }
    CHECK(source.read_share() == 1.0);
    CHECK(bytes_read() - before < most);
    CHECK(scans > 295);
    CHECK(source.info().scans == scans);
    CHECK(refused_with([&] { source.use_columns(1800); }, "900", "again"));
    before = bytes_read();
    CHECK(inspect(directory.file(name)).scans == scans);
    CHECK(bytes_read() - before < most);
  }
}

TEST_CASE("a sensor that begins later than the one that is read is named at the end") {
  auto packets = velodyne_capture({.duration_s = 6.0});
  for (Captured late : velodyne_capture({.duration_s = 1.0})) {
    late.time_ns += 4'000'000'000;
    late.port = 2369;
    packets.push_back(late);
  }
  std::ranges::stable_sort(packets, {}, &Captured::time_ns);
  const Capture capture(packets);
  auto source = Recording::open(capture.path);
  CHECK(source.warnings().empty());
  CHECK(all_scans(source).size() >= 58);
  CHECK(one_line_with(source.warnings(), "192.168.1.201:2369", "--stream"));
  CHECK(all_scans(Recording::open(capture.path, {.stream = "2369"})).size() >= 8);
}

TEST_CASE("a capture of less than a turn is refused at its end, stamps of one's own at once") {
  const Capture capture(velodyne_capture({.duration_s = 0.03}));
  auto source = Recording::open(capture.path);
  CHECK(refused_with([&] { source.next(); }, "at least one turn"));
  CHECK_FALSE(source.next());
  CHECK(refused_with([&] { Recording::open(capture.path, {.files = {.stamps = "stamps.txt"}}); },
                     "--stamps does not apply", "a capture or a bag"));
}

TEST_CASE("the user's sensor wins over the packets, with a warning") {
  const Capture capture(velodyne_capture({.product = 0x21}));  // says HDL-32E
  const std::string& path = capture.path;
  auto found = Recording::open(path);
  CHECK(found.sensor().name == "vlp-16");
  CHECK(one_line_with(found.warnings(), "hdl-32e", "1327 us", "vlp-16"));
  auto wanted = Recording::open(path, {.sensor = "hdl-32e"});
  CHECK(wanted.sensor().name == "hdl-32e");
  REQUIRE(wanted.warnings().size() >= 1);
  CHECK(one_line_with(wanted.warnings()[0], "vlp-16", "hdl-32e", "named sensor"));
  CHECK(Recording::open(path, {.sensor = "vlp-16"}).warnings().empty());
  CHECK(refused_with([&] { Recording::open(path, {.sensor = "hdl-64e"}); }, "16, 32 or 128",
                     "hdl-64e"));
}

TEST_CASE("several sensors in a capture are listed and chosen by port or sender") {
  auto packets = velodyne_capture();
  auto others = velodyne_capture({.rate_hz = 5.0, .duration_s = 0.5});
  for (Captured& other : others) {
    other.port = 2369;
    other.sender = 202;
  }
  packets.insert(packets.end(), others.begin(), others.end());
  std::ranges::stable_sort(packets, {}, &Captured::time_ns);
  const Capture capture(packets);
  const std::string& path = capture.path;
  CHECK(refused_with([&] { Recording::open(path); }, "192.168.1.201:2368", "192.168.1.202:2369",
                     "--stream"));
  const SensorModel slow = Recording::open(path, {.stream = "2369"}).sensor();
  CHECK(slow.scan_period_s == doctest::Approx(0.2).scale(0).epsilon(0.01));
  CHECK(slow.columns == 3600);  // twice those at ten turns a second
  CHECK(Recording::open(path, {.stream = "192.168.1.201:2368"}).sensor().scan_period_s ==
        doctest::Approx(0.1).scale(0).epsilon(0.01));
  CHECK(refused_with([&] { Recording::open(path, {.stream = "7502"}); }, "7502",
                     "192.168.1.201:2368"));
}

TEST_CASE("an Ouster's metadata are found beside the capture") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("a.pcap");
  write_file(path, pcap_bytes(ouster_turns(OusterProfile::kRng15, {7, 8, 9}), 1480));
  CHECK(refused_with([&] { Recording::open(path); }, "metadata", ".json"));
  write_file(directory.file("unrelated.json"), "{\"a\": 1}");
  write_file(directory.file("other.json"), ouster_metadata_text(OusterProfile::kLegacy));
  write_file(directory.file("sensor_1.json"), ouster_metadata_text(OusterProfile::kRng15));
  auto source = Recording::open(path);
  CHECK(source.sensor().rows() == 8);
  const auto scans = all_scans(source);
  REQUIRE(scans.size() == 3);
  const RecordingInfo info = inspect(path);
  CHECK(info.first_stamp_s == doctest::Approx(scans[0].stamp_s).scale(0).epsilon(1e-15));
  CHECK(info.duration_s == doctest::Approx(0.15).scale(0).epsilon(1e-3));
  write_file(directory.file("sensor_2.json"), ouster_metadata_text(OusterProfile::kRng15));
  CHECK(refused_with([&] { Recording::open(path); }, "sensor_1.json", "sensor_2.json"));
  write_file(directory.file("a_0.json"), ouster_metadata_text(OusterProfile::kRng15));
  CHECK(all_scans(Recording::open(path)).size() == 3);
  // The file of the capture's own name comes first, and must fit.
  write_file(directory.file("a.json"), ouster_metadata_text(OusterProfile::kLegacy));
  CHECK(refused_with([&] { Recording::open(path); }, "LEGACY", "bytes"));
  CHECK(all_scans(Recording::open(path, {.sensor = directory.file("sensor_2.json")})).size() == 3);
  CHECK(refused_with([&] { Recording::open(path, {.sensor = "os1-64"}); }, "metadata", "os1-64"));
}

TEST_CASE("every real capture and bag opens from its path alone") {
  // A period of 0: known from its metadata, or the packets may be cut off.
  using Expected = std::tuple<const char*, const char*, int, std::size_t, double>;
  for (const auto& [file, sensor, rows, count, period_s] :
       {Expected{"packets/velodyne/vlp-16_90deg_1200rpm_50rev.pcap", "vlp-16", 16, 50, 0.05},
        Expected{"packets/velodyne/hdl-32e_driving_18rev.pcap", "hdl-32e", 32, 17, 0.085},
        Expected{"packets/velodyne/vlp-16_old_firmware.pcap", "vlp-16", 16, 1, 0.1},
        Expected{"packets/velodyne/vlp-16_dual_return.db3", "vlp-16", 16, 4, 0.0},
        Expected{"packets/velodyne/vlp-32c.db3", "vlp-32c", 32, 5, 0.0},
        Expected{"packets/ouster/OS-0-128-U1_v2.3.0_1024x10.pcap", "OS-0-128", 128, 1, 0.0},
        Expected{"packets/ouster/OS-0-32-U1_v2.2.0_1024x10.pcap", "OS-0-32-U1", 32, 1, 0.0},
        Expected{"ouster/OS-1-64_1024x10_fw20.pcap", "OS-1-64_1024x10_fw20", 64, 1, 0.0},
        Expected{"ouster/OS-1-32-G_v2.1.1_1024x10.pcap", "OS-1-32-G", 32, 1, 0.0}}) {
    const auto path = real_data(file);
    if (!path) return;
    CAPTURE(file);
    auto source = Recording::open(*path);
    CHECK(source.sensor().name == sensor);
    CHECK(source.sensor().rows() == rows);
    const auto scans = all_scans(source);
    CHECK(scans.size() == count);
    for (const RecordedScan& scan : scans) {
      CHECK(scan.counts.kept > 500);
      CHECK(scan.stamp_s > 1.3e9);
    }
    if (period_s == 0.0) continue;
    CHECK(source.sensor().scan_period_s == doctest::Approx(period_s).scale(0).epsilon(0.02));
    CHECK(source.info().packets.lost == 0);
    CHECK(source.info().packets.late == 0);
  }
}

TEST_CASE("a simulated drive opens with the inertial data beside its scans, if there are any") {
  const TemporaryDirectory drive;
  const std::string path = drive.path();
  const SensorModel sensor = sensor_preset("vlp-16");
  write_sensor_json(sensor, drive.file("sensor.json"));
  const RangeImage image = flat_image(sensor.rows(), sensor.columns, 5.0F);
  write_stack(drive.file("scans.npy"), {image, flat_image(image.rows, image.columns, 6.0F)});
  CHECK(Recording::open(path).next()->imu.empty());
  write_file(drive.file("imu.csv"), "0.04,0,0,0,0,0,9.8\n0.06,0,0,0,0,0,9.8\n");
  const auto scans = all_scans(Recording::open(path));
  REQUIRE(scans.size() == 2);
  REQUIRE(scans[1].imu.size() == 1);
  CHECK(scans[1].imu[0].stamp_s == 0.06);
  write_file(drive.file("imu.csv"), "1,2,3\n");
  CHECK(refused_with([&] { Recording::open(path); }, "imu.csv", "7 numbers"));
}
