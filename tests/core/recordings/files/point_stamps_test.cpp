#include "vlp16_files.h"

using namespace hqslam::recordings;

// The stamps of scans that are files of points.

TEST_CASE("stamps come from KITTI's timestamps.txt, from a file, or from the files' names") {
  const TemporaryDirectory directory;
  const std::string folder = directory.file("drive");
  std::filesystem::create_directories(folder + "/velodyne_points/data");
  for (const char* name : {"1600000000.25", "1600000000.35", "1600000000.55"}) {
    write_file(folder + "/velodyne_points/data/" + name + ".txt", firing_order(0.0, 360.0));
  }
  const auto stamps = [&](const RecordingOptions& options) {
    return stamps_s(*open_scan_files(folder, sensor_preset("vlp-16"), options));
  };
  CHECK(stamps({}) == std::vector{0.0, 0.1, 0.2});
  CHECK(stamps({.stamps = kStampsFromNames}) ==
        std::vector{1600000000.25, 1600000000.35, 1600000000.55});
  CHECK(stamps({.stamps = "0.25"}) == std::vector{0.0, 0.25, 0.5});
  write_file(folder + "/velodyne_points/timestamps.txt",
             "1970-01-02 00:00:01.500000000\n1970-01-02 00:00:01.750000000\n"
             "1970-01-03 01:02:03\n");
  CHECK(stamps({}) == std::vector{86401.5, 86401.75, 2.0 * 86400.0 + 3723.0});
  write_file(directory.file("stamps.txt"), "# of my robot\n10.5\n10.625\n\n11\n");
  CHECK(stamps({.stamps = directory.file("stamps.txt")}) == std::vector{10.5, 10.625, 11.0});
  const auto complaint = [&](const char* contents) {
    write_file(directory.file("stamps.txt"), contents);
    return error_message([&] { stamps({.stamps = directory.file("stamps.txt")}); });
  };
  CHECK(one_line_with(complaint("10.5\n"), "stamps.txt", "3 scans", "1"));
  CHECK(one_line_with(complaint("10.5\n11\n12\n13\n"), "stamps.txt", "3 scans", "4"));
  CHECK(one_line_with(complaint("# nothing\n"), "stamps.txt", "found none"));
  CHECK(one_line_with(complaint("10.5\nyesterday\n11\n"), "line 2", "yesterday"));
}

TEST_CASE("scans without stamps whose files are numbered with gaps are that many periods apart") {
  // In: names of files. Out: periods from the first scan to each.
  const auto found = [](const std::vector<std::string>& names, CaptureTime capture) {
    const TemporaryDirectory directory;
    for (const std::string& name : names) {
      write_file(directory.file(name + ".txt"), firing_order(0.0, 360.0));
    }
    const auto source = open_vlp16(directory, capture);
    const std::vector<double> found_s = stamps_s(*source);
    std::vector<long> periods;
    for (const double stamp_s : found_s) {
      periods.push_back(std::lround(10.0 * (stamp_s - found_s.front())));
    }
    return std::pair(periods, fmt::format("{}", fmt::join(source->warnings(), " ")));
  };
  using Periods = std::vector<long>;
  for (const CaptureTime capture : {CaptureTime::kMotionCorrected, CaptureTime::kRolling}) {
    const auto [periods, warning] = found({"scan_07", "scan_10", "scan_11"}, capture);
    CHECK(periods == Periods{0, 3, 4});
    CHECK(warning.find("numbered 7 to 11, and 2 of") != std::string::npos);
    CHECK(found({"8", "9"}, capture).first == Periods{0, 1});
    for (const char* clock : {"0100", "1600000000003"}) {
      CHECK(found({"0", clock}, capture).first == Periods{0, 1});
    }
  }
}

TEST_CASE("times that rise from scan to scan are a clock's, whatever its zero") {
  const auto found_from = [](double first_s, double step_s) {
    const TemporaryDirectory directory;
    for (const int i : {0, 1, 3}) {  // a scan is missing
      const double t_s = first_s + step_s * i;
      write_file(directory.file(fmt::format("{}.csv", i)),
                 fmt::format("x,y,z,t\n5,0,0.2616,{}\n5,0,-1.1507,{}\n", t_s, t_s + 0.1));
    }
    return stamps_s(*open_vlp16(directory));
  };
  for (const double uptime_s : {0.0, 300.0, 400'000.0}) {
    const std::vector<double> found_s = found_from(uptime_s, 0.1);
    REQUIRE(found_s.size() == 3);
    for (const auto& [scan, turn] : {std::pair(0, 0), std::pair(1, 1), std::pair(2, 3)}) {
      CHECK(found_s[scan] == doctest::Approx(uptime_s + 0.1 * turn + 0.05).epsilon(1e-9));
    }
  }
  // Times within each scan: the files' numbers count the missing one.
  CHECK(found_from(0.0, 0.0) == std::vector{0.0, 0.1, 3 * 0.1});
}

TEST_CASE("points without times get that of their azimuth, counted on from scan to scan") {
  const TemporaryDirectory directory;
  // Scans of 364 degrees, one after the other, as drivers cut them by a number of packets.
  write_scans(directory, 4, [](int i) { return firing_order(40.0 + 364.0 * i, 364.0); });
  const auto source = open_vlp16(directory);
  for (int i = 0; i < 4; ++i) {
    const auto scan = source->next().value();
    CHECK(scan.stamp_s == doctest::Approx(0.1 * 364.0 / 360.0 * (i + 0.5)).epsilon(0.002));
    // The head stands at 40 + 364 (i + 1/2) degrees, clockwise, in the middle of the scan.
    const double middle_rad = -radians(40.0 + 364.0 * (i + 0.5));
    const std::size_t middle = scan.cloud.index(3, source->sensor().column_of_azimuth(middle_rad));
    float nearest_s = 1.0F;
    for (std::size_t at = middle - 4; at < middle + 4; ++at) {
      if (scan.cloud.range_m[at] > 0.0F) {
        nearest_s = std::min(nearest_s, std::abs(scan.cloud.time_offset_s[at]));
      }
    }
    CHECK(nearest_s < 0.0005F);
    for (const float offset_s : scan.cloud.time_offset_s) CHECK(std::abs(offset_s) < 0.051F);
  }
  CHECK(source->warnings().empty());
  const auto corrected = open_vlp16(directory, std::nullopt);
  CHECK(corrected->next()->cloud.time_offset_s.empty());
  CHECK(one_line_with(corrected->warnings(), "taken as corrected for motion"));
}

TEST_CASE("scans that are cropped to a part of the turn are a turn apart, parts of turns are not") {
  const auto check = [](const auto& contents, double step_s, double first_s) {
    const TemporaryDirectory directory;
    write_scans(directory, 4, contents);
    const std::vector<double> found_s = stamps_s(*open_vlp16(directory));
    REQUIRE(found_s.size() == 4);
    for (int i = 0; i < 4; ++i) CHECK(std::abs(found_s[i] - first_s - step_s * i) < 2e-4);
  };
  check([](int i) { return firing_order(-60.0 + 360.0 * i, 120.0); }, 0.1, 0.1 / 6.0);
  // Turns that begin in front, of which the back is cropped.
  const auto without_back = [](int i) {
    return firing_order(360.0 * i, 60.0) + firing_order(360.0 * i + 300.0, 60.0);
  };
  check(without_back, 0.1, 0.05);
  check([](int i) { return firing_order(180.0 * i, 180.0); }, 0.05, 0.025);
}

TEST_CASE("turns are counted on over scans that cannot be read or have no points") {
  const auto found_with = [](int missing, const std::string& contents) {
    const TemporaryDirectory directory;
    write_scans(directory, 4, [&](int i) {
      return i == missing ? contents : firing_order(40.0 + 364.0 * i, 364.0);
    });
    const auto source = open_vlp16(directory);
    std::vector<double> result;
    for (int i = 0; i < 4; ++i) {
      try {
        result.push_back(source->next()->stamp_s);
      } catch (const ScanError&) {
        CHECK(i == missing);
      }
    }
    return result;
  };
  const auto middle_s = [](int i) {
    return doctest::Approx(0.1 * 364.0 / 360.0 * (i + 0.5)).epsilon(0.002);
  };
  const std::string no_points = "nan nan nan 7 0\n";
  for (const int missing : {1, 2}) {
    CAPTURE(missing);
    const std::vector<double> read_s = found_with(missing, "this is no scan");
    REQUIRE(read_s.size() == 3);
    CHECK(read_s[0] == middle_s(0));
    CHECK(read_s[1] == middle_s(missing == 1 ? 2 : 1));
    CHECK(read_s[2] == middle_s(3));
    const std::vector<double> all_s = found_with(missing, no_points);
    REQUIRE(all_s.size() == 4);
    CHECK(all_s[missing] == doctest::Approx(0.1 * (missing + 0.5)));
    CHECK(all_s[missing + 1] == middle_s(missing + 1));
    CHECK(all_s[3] == middle_s(3));
  }
  // The first scan that is read is where the times begin.
  CHECK(found_with(0, "this is no scan").front() == middle_s(0));
  CHECK(found_with(0, no_points).front() == doctest::Approx(0.05));
  CHECK(found_with(0, no_points)[1] == doctest::Approx(0.1 + 0.05 * 364.0 / 360.0).epsilon(0.002));
}
