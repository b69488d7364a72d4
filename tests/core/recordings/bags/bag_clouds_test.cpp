#include <ctime>

#include "made_bags.h"

using namespace hqslam::recordings;

// The clouds of a bag, as drivers of all makers write them.

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
    const std::size_t behind = cloud.index(0, source.sensor().column_of(0, 3.14));
    CHECK(cloud.range_m[behind] == doctest::Approx(5.0).epsilon(1e-5));
    CHECK(cloud.points_m[behind].z() > 1.0F);
    CHECK(std::abs(cloud.time_offset_s[behind]) < 0.01 * form.period_s);
  }
}

TEST_CASE("messages of half a turn, of a twentieth and of two turns are scans of one turn") {
  std::vector<CloudPoint> all;  // six turns
  for (int turn = 0; turn < 6; ++turn) {
    auto of_turn = round_cloud(0.1, 1.0, 0.1 * turn);
    for (CloudPoint& point : of_turn) point.x *= 1.0F + 1e-4F * static_cast<float>(turn);
    all.insert(all.end(), of_turn.begin(), of_turn.end());
  }
  for (const double message_s : {0.1, 0.05, 0.005, 0.2}) {
    CAPTURE(message_s);
    std::vector<BagMessage> messages;
    const auto each = std::lround(message_s / 0.6 * static_cast<double>(all.size()));
    for (std::size_t at = 0; at < all.size(); at += each) {
      std::vector<CloudPoint> points(all.begin() + at, all.begin() + at + each);
      const double begin_s = points.front().time;
      for (CloudPoint& point : points) point.time -= begin_s;
      const auto stamp_ns = 1'600'000'000'000'000'000 + std::llround(1e9 * begin_s);
      messages.push_back(
          {"/points", kCloudType, stamp_ns, cloud_message(stamp_ns, points, false, 7)});
    }
    const Bag bag(messages);
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
    auto corrected = bag.open({.files = {.capture = CaptureTime::kMotionCorrected}});
    CHECK(corrected.next()->cloud.time_offset_s.empty());
  }
}

TEST_CASE("clouds that were thinned out get as few columns as they have points, unless stated") {
  const Bag bag(cloud_messages());  // of 360 columns
  for (const int stated : {0, 1800}) {
    auto source = bag.open({.sensor = "vlp-16", .columns = stated});
    CHECK(source.sensor().columns == (stated == 0 ? 360 : stated));
    CHECK(source.next()->cloud.columns == source.sensor().columns);
    CHECK(source.warnings().size() == (stated == 0 ? 1 : 0));
  }
}

TEST_CASE("clouds whose stamps were never set have those of their recording, and a note") {
  auto messages = cloud_messages();
  for (BagMessage& message : messages) message.bytes = cloud_message(0, round_cloud(0.1), false, 7);
  const Bag bag(messages);
  auto source = bag.open({.sensor = "vlp-16", .columns = 720});
  CHECK(source.next()->stamp_s == doctest::Approx(1.6e9 + 0.055).epsilon(1e-12));
  CHECK(one_line_with(source.warnings(), "without stamps"));
}

TEST_CASE("clouds without times are said to be as captured by the option, packets are not") {
  auto messages = cloud_messages();
  messages.resize(1);
  messages[0].bytes = cloud_message(1'600'000'000'000'000'000, round_cloud(0.0), false, 7);
  const Bag bag(messages);
  OpenOptions options = {.sensor = "vlp-16"};
  CHECK(bag.open(options).next()->cloud.time_offset_s.empty());
  options.files.capture = CaptureTime::kRolling;
  const auto scan = bag.open(options).next();
  CHECK_FALSE(scan->cloud.time_offset_s.empty());
  CHECK(scan->stamp_s == doctest::Approx(1.6e9).epsilon(1e-15));
  CHECK(refused_with([&] { Bag(velodyne_messages(false)).open(options); }, "--capture", "leave"));
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
          const auto field = message.bytes.begin() + at + first;
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
