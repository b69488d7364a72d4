#include "bags/bag.h"

#include <zstd.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>

#include "bags.h"
#include "captures.h"
#include "hqslam/core/error.h"
#include "hqslam/recordings/recording.h"
#include "streams/stream_reader.h"
#include "testing.h"

using namespace hqslam;
using namespace hqslam::recordings;
using namespace hqslam::test;

namespace {

constexpr const char* kCloudType = "sensor_msgs/msg/PointCloud2";

/// A VLP-16's packets as messages of ten packets.
std::vector<BagMessage> velodyne_messages(bool ros1) {
  auto messages = scan_messages("/velodyne_packets", "velodyne_msgs/msg/VelodyneScan",
                                velodyne_capture({.duration_s = 0.45}), 10, ros1);
  messages.insert(messages.begin() + 1, {"/other", "std_msgs/msg/String", messages[0].time_ns,
                                         text_message("nothing", ros1)});
  return messages;
}

/// How a driver writes the points of a turn.
struct CloudForm {
  const char* ring = "ring";
  const char* time = "timestamp";
  std::uint8_t type = 7;
  double unit_s = 1.0;
  std::optional<double> clock_s = std::nullopt;  ///< of the first turn; none: each begins at 0
  double period_s = 0.1;
  bool highest_first = false;
  bool with_nan = false;
};

/// Five clouds, the fourth of which never came.
std::vector<BagMessage> cloud_messages(const CloudForm& form = {}) {
  std::vector<BagMessage> messages;
  for (const int i : {0, 1, 2, 4}) {
    const double since_s = form.period_s * i;
    const auto begin_ns = static_cast<std::int64_t>(1e9 * (1'600'000'000.0 + since_s));
    auto points =
        round_cloud(form.period_s, form.unit_s, form.clock_s ? *form.clock_s + since_s : 0.0);
    for (CloudPoint& point : points) {
      if (form.with_nan && point.ring == 3 && point.x > 4.0F) point.x = std::nanf("");
      if (form.highest_first) point.ring = static_cast<std::uint16_t>(15 - point.ring);
    }
    messages.push_back({"/points", kCloudType, begin_ns + 5'000'000,
                        cloud_message(begin_ns, points, false, form.type, form.time, form.ring)});
  }
  return messages;
}

/// The packets of a turn of an Ouster as messages.
std::vector<BagMessage> ouster_messages(const std::string& topic, std::uint32_t id, int rows = 8) {
  std::vector<BagMessage> messages;
  for (const Captured& packet : ouster_turn(OusterProfile::kRng19, id, rows)) {
    messages.push_back({topic, "ouster_sensor_msgs/msg/PacketMsg", packet.time_ns,
                        buffer_message(packet.payload, false)});
  }
  return messages;
}
BagMessage metadata_message(const std::string& topic, const std::string& text) {
  return {topic, "std_msgs/msg/String", 1, text_message(text, false)};
}

/// These messages in a folder of their own.
struct Bag {
  TemporaryDirectory folder;
  std::string path = folder.file("a.mcap");

  explicit Bag(const std::vector<BagMessage>& messages) {
    write_file(path, mcap_bytes(messages, "zstd"));
  }
  Recording open(const OpenOptions& options = {.sensor = "vlp-16"}) const {
    return Recording::open(path, options);
  }
};

std::vector<RecordedScan> scans_of(const std::vector<BagMessage>& messages,
                                   const OpenOptions& options = {}) {
  const Bag bag(messages);
  return all_scans(bag.open(options));
}

}  // namespace

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
  const auto expected = all_scans(Recording::open(directory.file("a.db3")));
  REQUIRE(expected.size() == 4);
  for (const char* name :
       {"a.mcap", "alz4.mcap", "azstd.mcap", "anone.bag", "alz4.bag", "abz2.bag", "folder"}) {
    CAPTURE(name);
    auto source = Recording::open(directory.file(name));
    CHECK(same_scans(all_scans(source), expected));
    CHECK(source.warnings().empty());  // nothing came twice
    CHECK(inspect(directory.file(name)).streams.size() == 2);
  }
}

TEST_CASE("a bag that was cut off gives the scans before the cut, and then says so") {
  const TemporaryDirectory directory;
  const std::vector<BagMessage> messages = velodyne_messages(false);
  const std::string whole = mcap_bytes(messages, "");
  // A chunk of all messages, and one behind it of which a half is there.
  const std::string chunk = whole.substr(0, whole.size() - 8 - 2 * 9 - 4 - 20);
  const std::string path = directory.file("a.mcap");
  write_file(path, chunk + whole.substr(8, whole.size() / 2));
  auto source = Recording::open(path);
  for (int i = 0; i < 4; ++i) CHECK(source.next());
  CHECK(refused_with([&] { source.next(); }, "cut off", "mcap recover"));
  CHECK_FALSE(source.next());
  CHECK(inspect(path).scans == 4);
  CHECK(inspect(path).warnings.at(0).find("cut off") != std::string::npos);
}

TEST_CASE("a bag of which a file is missing gives the others, and then says so") {
  const TemporaryDirectory directory;
  write_db3(cloud_messages(), directory.file("a_0.db3"));
  write_file(directory.file("metadata.yaml"),
             "rosbag2_bagfile_information:\n  topics:\n    - name\n  relative_file_paths:\n"
             "    - a_0.db3\n    - a_1.db3\n");
  auto source = Recording::open(directory.path().string());
  for (int i = 0; i < 4; ++i) CHECK(source.next());
  CHECK(refused_with([&] { source.next(); }, "missing: a_1.db3"));
  std::filesystem::rename(directory.file("a_0.db3"), directory.file("a_0.db3.zstd"));
  CHECK(refused_with([&] { Recording::open(directory.path().string()); }, "unzstd"));
}

TEST_CASE("messages that were compressed by themselves are read") {
  const TemporaryDirectory directory;
  auto messages = cloud_messages();
  for (BagMessage& message : messages) {
    Payload packed(ZSTD_compressBound(message.bytes.size()));
    packed.resize(
        ZSTD_compress(packed.data(), packed.size(), message.bytes.data(), message.bytes.size(), 1));
    message.bytes = packed;
  }
  write_db3(messages, directory.file("a.db3"));
  CHECK(all_scans(Recording::open(directory.file("a.db3"))).size() == 4);
}

TEST_CASE("clouds that say that they are big-endian are read, be they so or not") {
  const auto whole = cloud_messages();
  constexpr std::size_t kStep = 26;
  const std::size_t kData = 16 * 360 * kStep;
  for (const bool is_so : {false, true}) {
    CAPTURE(is_so);
    auto messages = whole;
    for (BagMessage& message : messages) {
      const std::size_t data = message.bytes.size() - kData - 1;
      message.bytes[data - 16] = 1;  // before point_step, row_step and the number of bytes
      for (std::size_t at = data; is_so && at + kStep < message.bytes.size(); at += kStep) {
        for (const auto& [first, count] : {std::pair(0, 4), {4, 4}, {8, 4}, {12, 2}, {18, 4}}) {
          const auto field = message.bytes.begin() + static_cast<std::ptrdiff_t>(at) + first;
          std::reverse(field, field + count);
        }
      }
    }
    const auto scans = scans_of(messages);
    REQUIRE(scans.size() == 4);
    CHECK(scans[1].counts.kept + scans[1].counts.hidden_by_nearer == 16 * 360);
  }
}

TEST_CASE("a Livox's own messages are named") {
  const Bag bag({{"/livox/lidar", "livox_ros_driver2/msg/CustomMsg", 1, Payload(8)}});
  CHECK(refused_with([&] { bag.open(); }, "CustomMsg", "PointCloud2", "xfer_format"));
}

TEST_CASE(
    "a bag whose recorder left the serialization format empty is read, one of another is not") {
  const TemporaryDirectory directory;
  write_db3(velodyne_messages(false), directory.file("a.db3"), "");
  CHECK(all_scans(Recording::open(directory.file("a.db3"))).size() == 4);
  write_db3(velodyne_messages(false), directory.file("b.db3"), "protobuf");
  CHECK(refused_with([&] { Recording::open(directory.file("b.db3")); }, "none"));
}

TEST_CASE("an Ouster's metadata are found wherever they stand in a bag") {
  std::vector<BagMessage> messages = ouster_messages("/lidar_packets", 1);
  for (const BagMessage& later : ouster_messages("/lidar_packets", 2)) messages.push_back(later);
  messages.push_back(metadata_message("/metadata", ouster_metadata_text(OusterProfile::kRng19)));
  messages.back().time_ns = messages[messages.size() - 2].time_ns + 10'000'000'000;
  CHECK(scans_of(messages).size() == 2);
}

TEST_CASE("a bag in write-ahead mode is read without a file being written beside it") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("50 % sure? #1.db3");
  write_db3(velodyne_messages(false), path);
  std::string bytes = file_contents(path);
  bytes[18] = bytes[19] = 2;  // of SQLite's header: the versions that write and read such a file
  write_file(path, bytes);
  auto source = Recording::open(path);
  CHECK(all_scans(source).size() == 4);
  const std::filesystem::directory_iterator files(directory.file("."));
  CHECK(std::distance(begin(files), end(files)) == 1);
}

TEST_CASE("the log that lies beside a bag in write-ahead mode is read with it") {
  const TemporaryDirectory directory;
  write_db3(velodyne_messages(false), directory.file("whole.db3"));
  copy_with_half_taken_back(directory.file("whole.db3"), directory.file("stopped.db3"));
  const auto scans = all_scans(Recording::open(directory.file("stopped.db3")));
  CHECK(!scans.empty());
  CHECK(scans.size() < 4);
}

TEST_CASE("of several Ousters in a bag each has its own metadata, whatever other texts are there") {
  const OusterProfile profile = OusterProfile::kRng19;
  std::vector<BagMessage> messages = {
      metadata_message("/camera/metadata", "{\"width\": 640}"),
      metadata_message("/front/metadata", ouster_metadata_text(profile, 8)),
      metadata_message("/rear/metadata", ouster_metadata_text(profile, 16))};
  for (const auto& [topic, rows] :
       {std::pair("/front/lidar_packets", 8), {"/rear/lidar_packets", 16}}) {
    for (const BagMessage& message : ouster_messages(topic, 1, rows)) messages.push_back(message);
  }
  const Bag bag(messages);
  CHECK(bag.open({.stream = "/front/lidar_packets"}).sensor().rows() == 8);
  CHECK(bag.open({.stream = "/rear/lidar_packets"}).sensor().rows() == 16);
}

TEST_CASE("of a bag's metadata no more is kept than an Ouster's may be") {
  const std::string text = ouster_metadata_text(OusterProfile::kRng19);
  std::vector<BagMessage> messages = velodyne_messages(false);
  const auto add = [&](const std::string& metadata) {
    messages.insert(messages.begin(), metadata_message("/metadata", metadata));
  };
  for (std::size_t i = 0; i < 2 * kMostMetadataTexts; ++i) add(text);
  add(text + std::string(kMostMetadata_bytes, ' '));
  for (std::size_t i = 0; i < kMostMetadataTexts; ++i) add("{\"of\": \"a camera\"}");
  const Bag bag(messages);
  const StreamReader reader(bag.path, "");
  CHECK(reader.metadata().size() == kMostMetadataTexts);
  for (const TopicText& kept : reader.metadata()) CHECK(kept.text == text);
}

TEST_CASE("a topic is passed over whose name or type is longer than any is, in every kind of bag") {
  const TemporaryDirectory directory;
  const auto with_long_names = [](bool ros1) {
    std::vector<BagMessage> messages = velodyne_messages(ros1);
    for (const std::size_t bytes : {kMaxNameBytes, kMaxNameBytes + 1}) {
      messages.push_back({std::string(bytes, 'n'), "a/msg/B", 1, Payload(8)});
      messages.push_back({"/" + std::to_string(bytes), std::string(bytes, 't'), 1, Payload(8)});
    }
    return messages;
  };
  write_db3(with_long_names(false), directory.file("a.db3"));
  write_file(directory.file("a.mcap"), mcap_bytes(with_long_names(false), "zstd"));
  write_file(directory.file("a.bag"), ros1_bytes(with_long_names(true), "bz2"));
  for (const char* name : {"a.db3", "a.mcap", "a.bag"}) {
    CAPTURE(name);
    CHECK(inspect(directory.file(name)).streams.size() == 4);
  }
}

TEST_CASE("a connection of a ROS 1 bag that is longer than any is refused") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.bag"),
             ros1_bytes({{"/a", std::string(1U << 20U, 't'), 1, Payload(8)}}, "bz2"));
  CHECK(refused_with([&] { Recording::open(directory.file("a.bag")); }, "at most 1048576 bytes"));
}

TEST_CASE("a bag whose messages are a view that never ends is refused") {
  const TemporaryDirectory directory;
  write_endless_db3(directory.file("a.db3"));
  CHECK(
      refused_with([&] { Recording::open(directory.file("a.db3")); }, "a.db3", "whole .db3 file"));
}

TEST_CASE("clouds of every unit and origin of times get the recording's stamps") {
  constexpr double kBegin_s = 1'600'000'000.0;
  for (const CloudForm& form : {CloudForm{.type = 8, .clock_s = kBegin_s},
                                {},
                                {.type = 6, .unit_s = 1e-9},
                                {.type = 6, .unit_s = 1e-6},
                                {.unit_s = 1e-3, .period_s = 0.05},
                                {.type = 8, .unit_s = 1e-9, .clock_s = kBegin_s, .period_s = 0.2},
                                {.type = 8, .clock_s = 127.0}}) {  // a clock of its own
    CAPTURE(form.period_s);
    CAPTURE(form.unit_s);
    CAPTURE(form.clock_s.value_or(0.0));
    const Bag bag(cloud_messages(form));
    const auto period_s = doctest::Approx(form.period_s).scale(0).epsilon(1e-3);
    auto unnamed = bag.open({});  // found in the points
    CHECK(unnamed.sensor().beam_elevation_rad == sensor_preset("vlp-16").beam_elevation_rad);
    CHECK(unnamed.sensor().columns == 360);
    CHECK(unnamed.warnings().front().find("vlp-16") != std::string::npos);
    CHECK(unnamed.sensor().scan_period_s == period_s);
    auto source = bag.open();
    CHECK(source.sensor().scan_period_s == period_s);
    const auto scans = all_scans(source);
    REQUIRE(scans.size() == 4);
    for (const auto& [scan, turn] : {std::pair(0, 0), {1, 1}, {2, 2}, {3, 4}}) {
      const double middle_s = form.period_s * (turn + 359.0 / 720.0);
      CHECK(scans[scan].stamp_s - kBegin_s == doctest::Approx(middle_s).epsilon(1e-3));
    }
    // A point behind the sensor is measured in the middle of the turn; rings count from below.
    const OrganizedCloud& cloud = scans[0].cloud;
    const std::size_t behind =
        cloud.index(0, source.sensor().column_of(0, std::numbers::pi - 1e-3));
    CHECK(cloud.range_m[behind] == doctest::Approx(5.0).epsilon(1e-5));
    CHECK(cloud.points_m[behind].z() > 1.0F);
    CHECK(std::abs(cloud.time_offset_s[behind]) < 0.01 * form.period_s);
  }
}

TEST_CASE("messages of half a turn, of a twentieth and of two turns are scans of one turn") {
  const auto messages_of = [&](double message_s) {
    std::vector<CloudPoint> all;  // six turns
    for (int turn = 0; turn < 6; ++turn) {
      auto of_turn = round_cloud(0.1, 1.0, 0.1 * turn);
      for (CloudPoint& point : of_turn) point.x *= 1.0F + 1e-4F * static_cast<float>(turn);
      all.insert(all.end(), of_turn.begin(), of_turn.end());
    }
    std::vector<BagMessage> messages;
    const auto each =
        static_cast<std::size_t>(std::lround(message_s / 0.6 * static_cast<double>(all.size())));
    for (std::size_t at = 0; at < all.size(); at += each) {
      std::vector<CloudPoint> points(all.begin() + static_cast<std::ptrdiff_t>(at),
                                     all.begin() + static_cast<std::ptrdiff_t>(at + each));
      const double begin_s = points.front().time;
      for (CloudPoint& point : points) point.time -= begin_s;
      const auto stamp_ns = 1'600'000'000'000'000'000 + std::llround(1e9 * begin_s);
      messages.push_back(
          {"/points", kCloudType, stamp_ns, cloud_message(stamp_ns, points, false, 7)});
    }
    return messages;
  };
  for (const double message_s : {0.1, 0.05, 0.005, 0.2}) {
    CAPTURE(message_s);
    const Bag bag(messages_of(message_s));
    for (const std::string sensor : {"", "vlp-16"}) {
      auto source = bag.open({.sensor = sensor});
      CHECK(source.sensor().scan_period_s == doctest::Approx(0.1).epsilon(0.01));
      const auto scans = all_scans(source);
      REQUIRE(scans.size() == 6);
      CHECK(scans[5].stamp_s - scans[0].stamp_s == doctest::Approx(0.5).epsilon(0.01));
      for (const RecordedScan& scan : scans) {
        CHECK(scan.counts.kept + scan.counts.hidden_by_nearer > 5700);
      }
    }
    CHECK(inspect(bag.path).scans == 6);
  }
}

TEST_CASE("clouds whose stamps were never set have those of their recording, and a note") {
  auto messages = cloud_messages();
  for (BagMessage& message : messages) {
    message.bytes = cloud_message(0, round_cloud(0.1), false, 7);
  }
  const Bag bag(messages);
  auto source = bag.open();
  CHECK(source.next()->stamp_s == doctest::Approx(1.6e9 + 0.055).epsilon(1e-12));
  REQUIRE(source.warnings().size() == 1);
  CHECK(source.warnings()[0].find("without stamps") != std::string::npos);
}

TEST_CASE("clouds without times are said to be as captured by the option, packets are not") {
  auto messages = cloud_messages();
  messages.resize(1);
  messages[0].bytes = cloud_message(1'600'000'000'000'000'000, round_cloud(0.0), false, 7);
  const Bag bag(messages);
  OpenOptions options = {.sensor = "vlp-16"};
  CHECK(bag.open(options).next()->cloud.time_offset_s.empty());
  options.files.without_times = CaptureTime::kRolling;
  const auto scan = bag.open(options).next();
  CHECK_FALSE(scan->cloud.time_offset_s.empty());
  CHECK(scan->stamp_s == doctest::Approx(1.6e9).epsilon(1e-15));
  const Bag packets(velodyne_messages(false));
  CHECK(refused_with([&] { packets.open(options); }, "--capture", "leave"));
}

TEST_CASE("clouds with the fields that drivers of any maker write are read") {
  constexpr double kBegin_s = 1'600'000'000.0;
  for (const CloudForm& form :
       {CloudForm{.type = 8, .clock_s = kBegin_s, .with_nan = true},  // RoboSense
        {.time = "time"},                                             // LSLiDAR
        {.type = 8, .clock_s = kBegin_s, .highest_first = true},      // Hesai
        {.ring = "channel", .time = "time_stamp", .type = 6, .unit_s = 1e-9, .highest_first = true},
        {.ring = "line", .time = "t"},
        {.ring = "laser_id", .time = "timeStamp"},
        {.time = "offset_time"},
        {.time = "t_offset"}}) {
    CAPTURE(form.ring);
    CAPTURE(form.time);
    const Bag bag(cloud_messages(form));
    auto source = bag.open({});
    CHECK(source.sensor().rows() == 16);
    const auto scans = all_scans(source);
    REQUIRE(scans.size() == 4);
    const OrganizedCloud& cloud = scans[1].cloud;
    const std::size_t behind = cloud.index(0, source.sensor().column_of(0, 3.14));
    CHECK(cloud.points_m[behind].z() == doctest::Approx(5.0 * std::sin(15.0 / 57.29577951)));
    CHECK(std::abs(cloud.time_offset_s[behind]) < 0.001);
    CHECK(scans[1].stamp_s - kBegin_s == doctest::Approx(0.15).epsilon(1e-3));
    CHECK((scans[1].invalid_points > 0) == form.with_nan);
  }
}

TEST_CASE("times that contradict the rate are refused in one line, scan by scan") {
  auto messages = cloud_messages();
  messages[1].bytes =
      cloud_message(1'600'000'000'100'000'000, round_cloud(0.4, 1.0, 0.0), false, 7);
  const Bag bag(messages);
  auto source = bag.open();
  CHECK(source.next());
  std::string complaint;
  try {
    source.next();
  } catch (const ScanError& error) {
    complaint = error.what();
  }
  CHECK(one_line_with(complaint, "a.mcap[1]", "timestamp", "0.1 s", "0.39"));
  CHECK(source.next());
}

TEST_CASE("clouds of four thousand million rows without a column are read at once") {
  auto messages = cloud_messages();
  const Payload one_row_of_none_with_five_fields = {1, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0};
  for (int i = 0; i < 30; ++i) {
    BagMessage empty = messages[1];
    empty.bytes = cloud_message(1'600'000'000'050'000'000 + i * 1'000'000, {}, false, 7);
    const auto height = std::search(empty.bytes.begin(), empty.bytes.end(),
                                    one_row_of_none_with_five_fields.begin(),
                                    one_row_of_none_with_five_fields.end());
    REQUIRE(height != empty.bytes.end());
    std::fill(height, height + 4, std::uint8_t{0xFF});
    messages.insert(messages.begin() + 1 + i, empty);
  }
  const Bag bag(messages);
  const std::clock_t begin = std::clock();
  CHECK(all_scans(bag.open()).size() == 34);
  const double processor_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  CHECK(processor_s < 10.0);  // a minute, were the rows counted
}
