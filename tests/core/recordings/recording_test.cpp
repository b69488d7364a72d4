#include "hqslam/recordings/recording.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>

#include "bags.h"
#include "captures.h"
#include "error_message.h"
#include "file_contents.h"
#include "hqslam/core/error.h"
#include "real_data.h"
#include "temporary_directory.h"

using namespace hqslam;
using namespace hqslam::recordings;
using namespace hqslam::test;

namespace {

std::vector<RecordedScan> all_scans(ScanSource& source) {
  std::vector<RecordedScan> scans;
  while (auto scan = source.next()) scans.push_back(std::move(*scan));
  return scans;
}

constexpr const char* kVelodyneType = "velodyne_msgs/msg/VelodyneScan";
constexpr const char* kCloudType = "sensor_msgs/msg/PointCloud2";

/// A VLP-16's packets as messages of ten packets.
std::vector<BagMessage> velodyne_messages(bool ros1) {
  const auto packets = velodyne_capture({.duration_s = 0.45});
  std::vector<BagMessage> messages;
  for (std::size_t i = 0; i + 10 <= packets.size(); i += 10) {
    const std::vector<Captured> part(packets.begin() + static_cast<std::ptrdiff_t>(i),
                                     packets.begin() + static_cast<std::ptrdiff_t>(i + 10));
    messages.push_back({"/velodyne_packets", kVelodyneType, part.front().time_ns,
                        velodyne_scan_message(part, ros1)});
    messages.push_back(
        {"/other", "std_msgs/msg/String", part.front().time_ns, text_message("nothing", ros1)});
  }
  return messages;
}

/// One turn of a VLP-16 in a round room of 5 m, from the front on; times in `unit_s` from `zero_s`.
std::vector<CloudPoint> round_cloud(double period_s, double unit_s, double zero_s) {
  std::vector<CloudPoint> points;
  for (int column = 0; column < 360; ++column) {
    for (int ring = 0; ring < 16; ++ring) {
      const double azimuth = -column * std::numbers::pi / 180.0;
      const double elevation = (-15.0 + 2.0 * ring) * std::numbers::pi / 180.0;
      CloudPoint point;
      point.x = static_cast<float>(5.0 * std::cos(elevation) * std::cos(azimuth));
      point.y = static_cast<float>(5.0 * std::cos(elevation) * std::sin(azimuth));
      point.z = static_cast<float>(5.0 * std::sin(elevation));
      point.ring = static_cast<std::uint16_t>(ring);
      point.time = (zero_s + period_s * column / 360.0) / unit_s;
      points.push_back(point);
    }
  }
  return points;
}

/// Five clouds, `period_s` apart, the fourth of which never came.
std::vector<BagMessage> cloud_messages(double period_s, double unit_s, bool absolute,
                                       std::uint8_t type, bool ros1) {
  std::vector<BagMessage> messages;
  for (const int i : {0, 1, 2, 4}) {
    const double begin_s = 1'600'000'000.0 + period_s * i;
    const auto begin_ns = static_cast<std::int64_t>(1e9 * begin_s);
    messages.push_back(
        {"/points", kCloudType, begin_ns + 5'000'000,
         cloud_message(begin_ns, round_cloud(period_s, unit_s, absolute ? begin_s : 0.0), ros1,
                       type)});
  }
  return messages;
}

}  // namespace

TEST_CASE("a capture of a VLP-16 opens without being told anything") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("a.pcap");
  write_file(path, pcap_bytes(velodyne_capture({.rate_hz = 20.0, .duration_s = 0.26})));
  const auto source = open_recording(path);
  CHECK(source->sensor().name == "vlp-16");
  CHECK(source->sensor().columns == 900);  // half of those at ten turns a second
  CHECK(source->sensor().scan_period_s == doctest::Approx(0.05).scale(0).epsilon(0.002));
  CHECK(source->warnings().empty());
  const auto scans = all_scans(*source);
  REQUIRE(static_cast<std::int64_t>(scans.size()) == source->size());
  REQUIRE(scans.size() == 5);
  CHECK(scans[2].stamp_s - scans[1].stamp_s == doctest::Approx(0.05).scale(0).epsilon(0.02));
  CHECK(scans[1].counts.kept > 14000);
  const RecordingInfo info = inspect(path);
  CHECK(info.scans == 5);
  CHECK(info.format == "Velodyne packets, single return");
  CHECK(info.duration_s == doctest::Approx(0.25).scale(0).epsilon(0.05));
  CHECK(info.streams.size() == 1);
  CHECK(info.stream == "192.168.1.201:2368");
}

TEST_CASE("the user's sensor wins over the packets, with a warning") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("a.pcap");
  RoundRoom room;
  room.product = 0x21;  // says HDL-32E
  write_file(path, pcap_bytes(velodyne_capture(room)));
  const auto found = open_recording(path);
  CHECK(found->sensor().name == "vlp-16");
  REQUIRE(found->warnings().size() == 1);
  CHECK(one_line_with(found->warnings()[0], "hdl-32e", "1327 us", "vlp-16"));
  const auto wanted = open_recording(path, {.sensor = "hdl-32e"});
  CHECK(wanted->sensor().name == "hdl-32e");
  REQUIRE(wanted->warnings().size() >= 1);
  CHECK(one_line_with(wanted->warnings()[0], "vlp-16", "hdl-32e", "asked"));
  CHECK(open_recording(path, {.sensor = "vlp-16"})->warnings().empty());
  CHECK(one_line_with(error_message([&] { open_recording(path, {.sensor = "hdl-64e"}); }),
                      "16, 32 or 128", "hdl-64e"));
}

TEST_CASE("several sensors in a capture are listed and chosen by port or sender") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("a.pcap");
  auto packets = velodyne_capture();
  auto others = velodyne_capture({.rate_hz = 5.0, .duration_s = 0.5});
  for (Captured& other : others) {
    other.port = 2369;
    other.sender = 202;
  }
  packets.insert(packets.end(), others.begin(), others.end());
  std::stable_sort(packets.begin(), packets.end(),
                   [](const Captured& a, const Captured& b) { return a.time_ns < b.time_ns; });
  write_file(path, pcap_bytes(packets));
  CHECK(one_line_with(error_message([&] { open_recording(path); }), "192.168.1.201:2368",
                      "192.168.1.202:2369", "--stream"));
  CHECK(open_recording(path, {.stream = "2369"})->sensor().scan_period_s ==
        doctest::Approx(0.2).scale(0).epsilon(0.01));
  CHECK(open_recording(path, {.stream = "192.168.1.201:2368"})->sensor().scan_period_s ==
        doctest::Approx(0.1).scale(0).epsilon(0.01));
  CHECK(one_line_with(error_message([&] { open_recording(path, {.stream = "7502"}); }), "7502",
                      "192.168.1.201:2368"));
}

TEST_CASE("an Ouster's metadata are found beside the capture") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("a.pcap");
  std::vector<Captured> packets;
  for (const std::uint32_t id : {7U, 8U, 9U}) {
    const auto turn = ouster_turn(OusterProfile::kRng15, id);
    packets.insert(packets.end(), turn.begin(), turn.end());
  }
  write_file(path, pcap_bytes(packets, 1480));
  CHECK(one_line_with(error_message([&] { open_recording(path); }), "metadata", ".json"));
  write_file(directory.file("unrelated.json"), "{\"a\": 1}");
  write_file(directory.file("other.json"), ouster_metadata_text(OusterProfile::kLegacy));
  write_file(directory.file("sensor_1.json"), ouster_metadata_text(OusterProfile::kRng15));
  const auto source = open_recording(path);
  CHECK(source->sensor().rows() == 8);
  CHECK(all_scans(*source).size() == 3);
  write_file(directory.file("sensor_2.json"), ouster_metadata_text(OusterProfile::kRng15));
  CHECK(one_line_with(error_message([&] { open_recording(path); }), "sensor_1.json",
                      "sensor_2.json"));
  // The file of the capture's own name comes first, and must fit.
  write_file(directory.file("a.json"), ouster_metadata_text(OusterProfile::kLegacy));
  CHECK(one_line_with(error_message([&] { open_recording(path); }), "LEGACY", "bytes"));
  CHECK(all_scans(*open_recording(path, {.sensor = directory.file("sensor_2.json")})).size() == 3);
  CHECK(one_line_with(error_message([&] { open_recording(path, {.sensor = "os1-64"}); }),
                      "metadata", "os1-64"));
}

TEST_CASE("every kind of bag carries the same packets") {
  const TemporaryDirectory directory;
  write_db3(velodyne_messages(false), directory.file("a.db3"));
  for (const char* compression : {"", "lz4", "zstd"}) {
    write_file(directory.file(std::string("a") + compression + ".mcap"),
               mcap_bytes(velodyne_messages(false), compression));
  }
  for (const char* compression : {"none", "lz4", "bz2"}) {
    write_file(directory.file(std::string("a") + compression + ".bag"),
               ros1_bytes(velodyne_messages(true), compression));
  }
  std::filesystem::create_directory(directory.file("folder"));
  write_file(directory.file("folder/metadata.yaml"), "rosbag2_bagfile_information:\n");
  write_db3(velodyne_messages(false), directory.file("folder/folder_0.db3"));
  const auto expected = all_scans(*open_recording(directory.file("a.db3")));
  REQUIRE(expected.size() == 4);
  for (const char* name :
       {"a.mcap", "alz4.mcap", "azstd.mcap", "anone.bag", "alz4.bag", "abz2.bag", "folder"}) {
    CAPTURE(name);
    const auto source = open_recording(directory.file(name));
    CHECK(source->size() == 4);
    const auto scans = all_scans(*source);
    REQUIRE(scans.size() == expected.size());
    for (std::size_t i = 0; i < scans.size(); ++i) {
      CHECK(scans[i].stamp_s == expected[i].stamp_s);
      CHECK(scans[i].cloud.range_m == expected[i].cloud.range_m);
    }
    CHECK(inspect(directory.file(name)).streams.size() == 2);
  }
}

TEST_CASE("a bag in write-ahead mode is read without a file being written beside it") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("50 % sure? #1.db3");
  write_db3(velodyne_messages(false), path);
  std::string bytes = file_contents(path);
  bytes[18] = bytes[19] = 2;  // of SQLite's header: the versions that write and read such a file
  write_file(path, bytes);
  const auto source = open_recording(path);
  CHECK(all_scans(*source).size() == 4);
  const std::filesystem::directory_iterator files(directory.file("."));
  CHECK(std::distance(begin(files), end(files)) == 1);
}

TEST_CASE("the log that lies beside a bag in write-ahead mode is read with it") {
  const TemporaryDirectory directory;
  write_db3(velodyne_messages(false), directory.file("whole.db3"));
  copy_with_half_taken_back(directory.file("whole.db3"), directory.file("stopped.db3"));
  const auto scans = all_scans(*open_recording(directory.file("stopped.db3")));
  CHECK(!scans.empty());
  CHECK(scans.size() < 4);
}

TEST_CASE("Ouster's packets and metadata are found in one bag") {
  const TemporaryDirectory directory;
  std::vector<BagMessage> messages;
  messages.push_back({"/ouster/metadata", "std_msgs/msg/String", 1,
                      text_message(ouster_metadata_text(OusterProfile::kRng19Dual), false)});
  for (const std::uint32_t id : {1U, 2U}) {
    for (const Captured& packet : ouster_turn(OusterProfile::kRng19Dual, id)) {
      messages.push_back({"/ouster/lidar_packets", "ouster_sensor_msgs/msg/PacketMsg",
                          packet.time_ns, buffer_message(packet.payload, false)});
      messages.push_back({"/ouster/imu_packets", "ouster_sensor_msgs/msg/PacketMsg", packet.time_ns,
                          buffer_message(Payload(48), false)});
    }
  }
  write_file(directory.file("a.mcap"), mcap_bytes(messages, "zstd"));
  const auto source = open_recording(directory.file("a.mcap"));
  CHECK(source->sensor().rows() == 8);
  CHECK(all_scans(*source).size() == 2);
}

TEST_CASE("clouds of every unit and origin of times get the recording's stamps") {
  struct Case {
    double period_s, unit_s;
    bool absolute;
    std::uint8_t type;
  };
  const TemporaryDirectory directory;
  for (const Case& c :
       {Case{0.1, 1.0, true, 8}, Case{0.1, 1.0, false, 7}, Case{0.1, 1e-9, false, 6},
        Case{0.1, 1e-6, false, 6}, Case{0.05, 1e-3, false, 7}, Case{0.2, 1e-9, true, 8}}) {
    CAPTURE(c.period_s);
    CAPTURE(c.unit_s);
    CAPTURE(c.absolute);
    write_file(directory.file("a.mcap"),
               mcap_bytes(cloud_messages(c.period_s, c.unit_s, c.absolute, c.type, false), "lz4"));
    CHECK(one_line_with(error_message([&] { open_recording(directory.file("a.mcap")); }),
                        "--sensor"));
    const auto source = open_recording(directory.file("a.mcap"), {.sensor = "vlp-16"});
    CHECK(source->sensor().scan_period_s == doctest::Approx(c.period_s).scale(0).epsilon(1e-3));
    const auto scans = all_scans(*source);
    REQUIRE(scans.size() == 4);
    const double middle_s = c.period_s * 359.0 / 720.0;
    CHECK(scans[0].stamp_s == doctest::Approx(1'600'000'000.0 + middle_s).scale(0).epsilon(1e-12));
    CHECK(scans[3].stamp_s - scans[2].stamp_s ==
          doctest::Approx(2.0 * c.period_s).scale(0).epsilon(1e-3));
    // A point behind the sensor is measured in the middle of the turn; rings count from below.
    const OrganizedCloud& cloud = scans[0].cloud;
    const std::size_t behind =
        cloud.index(0, source->sensor().column_of(0, std::numbers::pi - 1e-3));
    CHECK(cloud.range_m[behind] == doctest::Approx(5.0).epsilon(1e-5));
    CHECK(cloud.points_m[behind].z() > 1.0F);
    CHECK(std::abs(cloud.time_offset_s[behind]) < 0.01 * c.period_s);
  }
}

TEST_CASE("times that contradict the rate are refused in one line, scan by scan") {
  const TemporaryDirectory directory;
  auto messages = cloud_messages(0.1, 1.0, false, 7, false);
  messages[1].bytes =
      cloud_message(1'600'000'000'100'000'000, round_cloud(0.4, 1.0, 0.0), false, 7);
  write_file(directory.file("a.mcap"), mcap_bytes(messages, ""));
  const auto source = open_recording(directory.file("a.mcap"), {.sensor = "vlp-16"});
  CHECK(source->next());
  CHECK_THROWS_AS(source->next(), ScanError);
  CHECK(source->next());
  const auto again = open_recording(directory.file("a.mcap"), {.sensor = "vlp-16"});
  again->next();
  CHECK(one_line_with(error_message([&] { again->next(); }), "a.mcap[1]", "timestamp", "0.1 s",
                      "0.39"));
}

TEST_CASE("clouds of four thousand million rows without a column are read at once") {
  const TemporaryDirectory directory;
  auto messages = cloud_messages(0.1, 1.0, false, 7, false);
  BagMessage empty = messages[1];
  empty.bytes = cloud_message(1'600'000'000'100'000'000, {}, false, 7);
  const Payload one_row_of_none_with_five_fields = {1, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0};
  const auto height =
      std::search(empty.bytes.begin(), empty.bytes.end(), one_row_of_none_with_five_fields.begin(),
                  one_row_of_none_with_five_fields.end());
  REQUIRE(height != empty.bytes.end());
  std::fill(height, height + 4, std::uint8_t{0xFF});
  messages.insert(messages.begin() + 1, 30, empty);
  write_file(directory.file("a.mcap"), mcap_bytes(messages, ""));
  const std::clock_t begin = std::clock();
  const auto source = open_recording(directory.file("a.mcap"), {.sensor = "vlp-16"});
  CHECK(all_scans(*source).size() == 34);
  const double processor_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  CHECK(processor_s < 10.0);  // a minute, were the rows counted
}

TEST_CASE("damaged bags are read or refused, nothing else") {
  const TemporaryDirectory directory;
  std::mt19937 random(5);
  write_db3(velodyne_messages(false), directory.file("valid.db3"));
  const auto clouds = [](bool ros1) { return cloud_messages(0.1, 1.0, true, 8, ros1); };
  struct Valid {
    const char* name;
    std::string bytes;
    bool stored = true;  ///< of compressed ones the least damage leaves nothing
  };
  for (const Valid& valid : {Valid{"a.mcap", mcap_bytes(velodyne_messages(false), "")},
                             Valid{"a.mcap", mcap_bytes(clouds(false), "zstd"), false},
                             Valid{"a.mcap", mcap_bytes(clouds(false), "")},
                             Valid{"a.bag", ros1_bytes(velodyne_messages(true), "none")},
                             Valid{"a.bag", ros1_bytes(clouds(true), "bz2"), false},
                             Valid{"a.bag", ros1_bytes(clouds(true), "none")},
                             Valid{"a.db3", file_contents(directory.file("valid.db3"))}}) {
    int refused = 0;
    int read = 0;
    for (int copy = 0; copy < 60; ++copy) {
      std::string bytes = valid.bytes;
      for (int edit = 0; edit < 6; ++edit) {
        const std::size_t reach = copy % 2 == 0 ? 400 : bytes.size();
        bytes[std::min<std::size_t>(20, bytes.size() - 1) + random() % (reach - 20)] =
            static_cast<char>(random());
      }
      if (copy % 5 == 0) bytes.resize(random() % bytes.size());
      write_file(directory.file(valid.name), bytes);
      const std::string message = error_message([&] {
        const auto source = open_recording(directory.file(valid.name), {.sensor = "vlp-16"});
        while (true) {
          try {
            if (!source->next()) break;
            ++read;
          } catch (const ScanError& error) {
            CHECK(one_line_with(error.what()));
          }
        }
      });
      CHECK(one_line_with(message));
      refused += message != "no Error" ? 1 : 0;
    }
    CAPTURE(valid.name);
    CHECK(refused > 0);
    CHECK((read > 0 || !valid.stored));
  }
}

TEST_CASE("every real capture and bag opens from its path alone") {
  struct Expected {
    const char* name;
    const char* sensor;
    int rows;
    std::int64_t scans;
  };
  for (const Expected& e :
       {Expected{"packets/velodyne/vlp-16_90deg_1200rpm_50rev.pcap", "vlp-16", 16, 50},
        Expected{"packets/velodyne/hdl-32e_driving_18rev.pcap", "hdl-32e", 32, 17},
        Expected{"packets/velodyne/vlp-16_old_firmware.pcap", "vlp-16", 16, 1},
        Expected{"packets/velodyne/vlp-16_dual_return.db3", "vlp-16", 16, 4},
        Expected{"packets/velodyne/vlp-32c.db3", "vlp-32c", 32, 5},
        Expected{"packets/ouster/OS-0-128-U1_v2.3.0_1024x10.pcap", "OS-0-128", 128, 1},
        Expected{"packets/ouster/OS-0-32-U1_v2.2.0_1024x10.pcap", "OS-0-32-U1", 32, 1},
        Expected{"ouster/OS-1-64_1024x10_fw20.pcap", "OS-1-64_1024x10_fw20", 64, 1},
        Expected{"ouster/OS-1-32-G_v2.1.1_1024x10.pcap", "OS-1-32-G", 32, 1}}) {
    const auto path = real_data(e.name);
    if (!path) return;
    CAPTURE(e.name);
    const auto source = open_recording(*path);
    CHECK(source->sensor().name == e.sensor);
    CHECK(source->sensor().rows() == e.rows);
    CHECK(source->size() == e.scans);
    const auto begin = std::chrono::steady_clock::now();
    const auto scans = all_scans(*source);
    const double ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    MESSAGE(e.name, ": ", ms / static_cast<double>(scans.size()), " ms a scan");
    CHECK(static_cast<std::int64_t>(scans.size()) == e.scans);
    for (const RecordedScan& scan : scans) {
      CHECK(scan.counts.kept > 500);
      CHECK(scan.stamp_s > 1.3e9);
    }
  }
}
