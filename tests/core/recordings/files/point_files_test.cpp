#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>

#include "files/scan_files.h"
#include "hqslam/core/angles.h"
#include "hqslam/core/cloud_file.h"
#include "hqslam/core/error.h"
#include "hqslam/core/left_out.h"
#include "hqslam/core/point_fields.h"
#include "recording_complaint.h"
#include "testing.h"

using namespace hqslam;
using namespace hqslam::recordings;
using namespace hqslam::test;

// Point files beyond .bin and .pcd, stamps and times that come from elsewhere, and units of a
// sensor that are off its table.

namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

RecordedScan only_scan(const std::string& path, const SensorModel& sensor,
                       const RecordingOptions& options = {}) {
  const auto source = open_scan_files(path, sensor, options);
  REQUIRE(source->size() == 1);
  return *source->next();
}

/// A point of 5 m in front of a VLP-16's beam of `elevation_deg`.
Eigen::Vector3d point_m(double azimuth_rad, double elevation_deg) {
  const double elevation_rad = elevation_deg * kTurn_rad / 360.0;
  return 5.0 * direction_of(azimuth_rad, elevation_rad);
}

template <typename T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// A scan of a VLP-16 as a .txt file without names: `turn_deg` degrees clockwise from
/// `first_deg` on, ring numbers from below.
std::string firing_order(double first_deg, double turn_deg, double off_deg = 0.0,
                         double pitch_deg = 0.0) {
  const Eigen::AngleAxisd pitch(pitch_deg * kTurn_rad / 360.0, Eigen::Vector3d::UnitY());
  std::string text;
  for (int i = 0; i * 0.5 < turn_deg; ++i) {
    for (int ring = 0; ring < 16; ++ring) {
      const Eigen::Vector3d p_m =
          pitch * point_m(-(first_deg + 0.5 * i) * kTurn_rad / 360.0, -15.0 + 2.0 * ring + off_deg);
      text += std::to_string(p_m.x()) + " " + std::to_string(p_m.y()) + " " +
              std::to_string(p_m.z()) + " 7 " + std::to_string(ring) + "\n";
    }
  }
  return text;
}

}  // namespace

TEST_CASE("a .csv file with names and a .txt file without give the same scan") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("vlp-16");
  write_file(directory.file("a.csv"),
             "t,ring,z,y,x\n0.00,9,0.2616,0,5\n0.05,1,-1.1507,0,5\n0.09,15,1.33975,0,5\n");
  write_file(directory.file("b.txt"),
             "# x y z intensity ring t\n5 0 0.2616 3 9 0.00\n5 0 -1.1507 3 1 0.05\n"
             "5 0 1.33975 3 15 0.09\n");
  const RecordedScan csv = only_scan(directory.file("a.csv"), sensor);
  const RecordedScan txt = only_scan(directory.file("b.txt"), sensor);
  CHECK(csv.counts.kept == 3);
  CHECK(csv.cloud.range_m == txt.cloud.range_m);
  CHECK(csv.cloud.time_offset_s == txt.cloud.time_offset_s);
  const int column = sensor.column_of_azimuth(0.0);
  CHECK(csv.cloud.range_m[csv.cloud.index(0, column)] > 5.0F);  // ring 15 is the highest beam
  CHECK(csv.cloud.time_offset_s[csv.cloud.index(0, column)] == doctest::Approx(0.045));
}

TEST_CASE("the names that the makers' programs give to columns are understood") {
  const TemporaryDirectory directory;
  const std::string points = ",0,5\n0.05,1,-1.1507,0,5\n0.09,15,1.33975,0,5\n";
  for (const char* names :
       {"t,ring,z,y,x\n", "TIMESTAMP (s), ROW, Z (m), Y (m), X (m)\n",
        "\"timestamp\",\"laser_id\",\"Points_m_XYZ:2\",\"Points_m_XYZ:1\",\"Points_m_XYZ:0\"\n",
        "scalar_GpsTime,scalar_ring,z,y,x\n"}) {
    CAPTURE(names);
    write_file(directory.file("a.csv"), names + ("0,9,0.2616" + points));
    const RecordedScan scan = only_scan(directory.file("a.csv"), sensor_preset("vlp-16"));
    CHECK(scan.counts.kept == 3);
    CHECK_FALSE(scan.cloud.time_offset_s.empty());
  }
}

TEST_CASE("points whose time is far from that of nearly all others are left out of the scan") {
  const TemporaryDirectory directory;
  for (const double wild_s : {4.294966295, -0.04}) {
    CAPTURE(wild_s);
    std::string text = fmt::format("x y z t\n5 0 0 {}\n", wild_s);
    for (int i = 0; i < 1000; ++i) {
      text +=
          fmt::format("{} {} 0 {}\n", 5 * std::cos(6e-3 * i), -5 * std::sin(6e-3 * i), 1e-4 * i);
    }
    write_file(directory.file("a.txt"), text);
    const Scan scan = read_cloud(directory.file("a.txt"));
    CHECK(scan.points_m.size() == 1000);
    CHECK(scan.invalid_points == 1);
    const auto [first_s, last_s] = std::ranges::minmax_element(scan.time_offset_s);
    CHECK(*last_s - *first_s == doctest::Approx(0.0999));
  }
}

TEST_CASE(".ply files of both forms are read") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("vlp-16");
  const std::string header =
      "element vertex 3\nproperty float x\nproperty double y\nproperty float z\n"
      "property uchar ring\nproperty uint t\nelement face 0\nproperty list uchar int "
      "v\nend_header\n";
  write_file(directory.file("a.ply"), "ply\nformat ascii 1.0\ncomment a test\n" + header +
                                          "5 0 0.2616 9 0\n5 0 -1.1507 1 50000000\n"
                                          "5 0 1.33975 15 90000000\n");
  std::string binary = "ply\nformat binary_little_endian 1.0\n" + header;
  const auto add = [&](float z, std::uint8_t ring, std::uint32_t t) {
    append(binary, 5.0F);
    append(binary, 0.0);
    append(binary, z);
    append(binary, ring);
    append(binary, t);
  };
  add(0.2616F, 9, 0);
  add(-1.1507F, 1, 50'000'000);
  add(1.33975F, 15, 90'000'000);
  write_file(directory.file("b.ply"), binary);
  const RecordedScan ascii = only_scan(directory.file("a.ply"), sensor);
  const RecordedScan packed = only_scan(directory.file("b.ply"), sensor);
  CHECK(ascii.counts.kept == 3);
  CHECK(ascii.cloud.range_m == packed.cloud.range_m);
  CHECK(ascii.cloud.time_offset_s == packed.cloud.time_offset_s);
  CHECK(ascii.cloud.time_offset_s[ascii.cloud.index(0, sensor.column_of_azimuth(0.0))] ==
        doctest::Approx(0.045));
}

TEST_CASE("a .ply file may announce as many points as a map has, if it is as long") {
  const TemporaryDirectory directory;
  const auto complaint = [&](const std::string& points) {
    write_file(directory.file("map.ply"),
               "ply\nformat binary_little_endian 1.0\nelement vertex " + points +
                   "\nproperty float x\nproperty float y\nproperty float z\nend_header\n123");
    return error_message([&] { only_scan(directory.file("map.ply"), sensor_preset("vlp-16")); });
  };
  CHECK(one_line_with(complaint("60000000"), "60000000 points of 12 bytes", "'3 bytes'"));
  CHECK(one_line_with(complaint("67108865"), "a number of points up to 67108864"));
}

TEST_CASE("stamps come from KITTI's timestamps.txt, from a file, or from the files' names") {
  const TemporaryDirectory directory;
  const SensorModel sensor = sensor_preset("vlp-16");
  const std::string folder = directory.file("drive");
  std::filesystem::create_directories(folder + "/velodyne_points/data");
  for (const char* name : {"1600000000.25", "1600000000.35", "1600000000.55"}) {
    write_file(folder + "/velodyne_points/data/" + name + ".txt", firing_order(0.0, 360.0));
  }
  const auto stamps = [&](const RecordingOptions& options) {
    std::vector<double> result;
    const auto source = open_scan_files(folder, sensor, options);
    while (const auto scan = source->next()) result.push_back(scan->stamp_s);
    return result;
  };
  CHECK(stamps({}) == std::vector<double>{0.0, 0.1, 0.2});
  CHECK(stamps({.stamps = kStampsFromNames}) ==
        std::vector<double>{1600000000.25, 1600000000.35, 1600000000.55});
  write_file(folder + "/velodyne_points/timestamps.txt",
             "1970-01-02 00:00:01.500000000\n1970-01-02 00:00:01.750000000\n"
             "1970-01-03 01:02:03\n");
  CHECK(stamps({}) == std::vector<double>{86401.5, 86401.75, 2.0 * 86400.0 + 3723.0});
  write_file(directory.file("stamps.txt"), "# of my robot\n10.5\n10.625\n\n11\n");
  CHECK(stamps({.stamps = directory.file("stamps.txt")}) ==
        std::vector<double>{10.5, 10.625, 11.0});
  const auto complaint = [&](const char* contents) {
    write_file(directory.file("stamps.txt"), contents);
    return error_message([&] { stamps({.stamps = directory.file("stamps.txt")}); });
  };
  CHECK(one_line_with(complaint("10.5\n"), "stamps.txt", "3 scans", "1"));
  CHECK(one_line_with(complaint("10.5\n11\n12\n13\n"), "stamps.txt", "3 scans", "4"));
  CHECK(one_line_with(complaint("# nothing\n"), "stamps.txt", "found none"));
  CHECK(one_line_with(complaint("10.5\nyesterday\n11\n"), "line 2", "yesterday"));
}

TEST_CASE("times that rise from scan to scan are a clock's, whatever its zero") {
  const auto stamps_s = [](double first_s, double step_s) {
    const TemporaryDirectory directory;
    for (const int i : {0, 1, 3}) {  // a scan is missing
      const double t_s = first_s + step_s * i;
      write_file(directory.file(fmt::format("{}.csv", i)),
                 fmt::format("x,y,z,t\n5,0,0.2616,{}\n5,0,-1.1507,{}\n", t_s, t_s + 0.1));
    }
    const auto source = open_scan_files(directory.path().string(), sensor_preset("vlp-16"));
    std::vector<double> result;
    while (const auto scan = source->next()) result.push_back(scan->stamp_s);
    return result;
  };
  for (const double uptime_s : {0.0, 300.0, 400'000.0}) {
    const std::vector<double> found_s = stamps_s(uptime_s, 0.1);
    REQUIRE(found_s.size() == 3);
    for (const auto& [scan, turn] : {std::pair(0, 0), std::pair(1, 1), std::pair(2, 3)}) {
      CHECK(found_s[scan] == doctest::Approx(uptime_s + 0.1 * turn + 0.05).epsilon(1e-9));
    }
  }
  CHECK(stamps_s(0.0, 0.0) == std::vector<double>{0.0, 0.1, 0.2});  // each scan's own
}

TEST_CASE("points without times get that of their azimuth, counted on from scan to scan") {
  const TemporaryDirectory directory;
  SensorModel sensor = sensor_preset("vlp-16");
  // Scans of 364 degrees, one after the other, as drivers cut them by a number of packets.
  for (int i = 0; i < 4; ++i) {
    write_file(directory.file(std::to_string(i) + ".txt"), firing_order(40.0 + 364.0 * i, 364.0));
  }
  const auto source =
      open_scan_files(directory.path().string(), sensor, {.without_times = CaptureTime::kRolling});
  for (int i = 0; i < 4; ++i) {
    const auto scan = source->next();
    REQUIRE(scan);
    CHECK(scan->stamp_s == doctest::Approx(0.1 * 364.0 / 360.0 * (i + 0.5)).epsilon(0.002));
    // The head stands at 40 + 364 (i + 1/2) degrees, clockwise, in the middle of the scan.
    const double middle_rad = -(40.0 + 364.0 * (i + 0.5)) * kTurn_rad / 360.0;
    const std::size_t middle = scan->cloud.index(3, sensor.column_of_azimuth(middle_rad));
    float nearest_s = 1.0F;
    for (std::size_t at = middle - 4; at < middle + 4; ++at) {
      if (scan->cloud.range_m[at] > 0.0F) {
        nearest_s = std::min(nearest_s, std::abs(scan->cloud.time_offset_s[at]));
      }
    }
    CHECK(nearest_s < 0.0005F);
    for (const float offset_s : scan->cloud.time_offset_s) CHECK(std::abs(offset_s) < 0.051F);
  }
  CHECK(source->warnings().empty());
  const auto corrected = open_scan_files(directory.path().string(), sensor);
  CHECK(corrected->next()->cloud.time_offset_s.empty());
  REQUIRE(corrected->warnings().size() == 1);
  CHECK(corrected->warnings()[0].find("taken as corrected for motion") != std::string::npos);
}

TEST_CASE("scans that are cropped to a part of the turn are a turn apart, parts of turns are not") {
  const auto stamps_s = [](const std::function<std::string(int)>& contents) {
    const TemporaryDirectory directory;
    for (int i = 0; i < 4; ++i) write_file(directory.file(std::to_string(i) + ".txt"), contents(i));
    const auto source = open_scan_files(directory.path().string(), sensor_preset("vlp-16"),
                                        {.without_times = CaptureTime::kRolling});
    std::vector<double> result;
    while (const auto scan = source->next()) result.push_back(scan->stamp_s);
    return result;
  };
  const auto check = [](const std::vector<double>& found_s, double step_s, double first_s) {
    REQUIRE(found_s.size() == 4);
    for (int i = 0; i < 4; ++i) CHECK(std::abs(found_s[i] - first_s - step_s * i) < 2e-4);
  };
  check(stamps_s([](int i) { return firing_order(-60.0 + 360.0 * i, 120.0); }), 0.1, 0.1 / 6.0);
  // Turns that begin in front, of which the back is cropped.
  check(stamps_s([](int i) {
          return firing_order(360.0 * i, 60.0) + firing_order(360.0 * i + 300.0, 60.0);
        }),
        0.1, 0.05);
  check(stamps_s([](int i) { return firing_order(180.0 * i, 180.0); }), 0.05, 0.025);
}

TEST_CASE("turns are counted on over scans that cannot be read or have no points") {
  const SensorModel sensor = sensor_preset("vlp-16");
  const auto stamps_s = [&](int missing, const std::string& contents) {
    const TemporaryDirectory directory;
    for (int i = 0; i < 4; ++i) {
      write_file(directory.file(std::to_string(i) + ".txt"),
                 i == missing ? contents : firing_order(40.0 + 364.0 * i, 364.0));
    }
    const auto source = open_scan_files(directory.path().string(), sensor,
                                        {.without_times = CaptureTime::kRolling});
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
    const std::vector<double> read_s = stamps_s(missing, "this is no scan");
    REQUIRE(read_s.size() == 3);
    CHECK(read_s[0] == middle_s(0));
    CHECK(read_s[1] == middle_s(missing == 1 ? 2 : 1));
    CHECK(read_s[2] == middle_s(3));
    const std::vector<double> all_s = stamps_s(missing, no_points);
    REQUIRE(all_s.size() == 4);
    CHECK(all_s[missing] == doctest::Approx(0.1 * (missing + 0.5)));
    CHECK(all_s[missing + 1] == middle_s(missing + 1));
    CHECK(all_s[3] == middle_s(3));
  }
  // The first scan that is read is where the times begin.
  CHECK(stamps_s(0, "this is no scan").front() == middle_s(0));
  CHECK(stamps_s(0, no_points).front() == doctest::Approx(0.05));
  CHECK(stamps_s(0, no_points)[1] == doctest::Approx(0.1 + 0.05 * 364.0 / 360.0).epsilon(0.002));
}

TEST_CASE("a unit whose beams are off the table by a degree is read with its own") {
  const TemporaryDirectory folder;
  const SensorModel sensor = sensor_preset("vlp-16");
  const OpenOptions options = {.sensor = "vlp-16",
                               .files = {.without_times = CaptureTime::kMotionCorrected}};
  write_file(folder.file("0.txt"), firing_order(0.0, 360.0, 0.8));
  auto recording = Recording::open(folder.path().string(), options);
  CHECK(recording.warnings().size() == 1);
  CHECK(recording.sensor() == sensor);  // as it was stated
  CHECK(recording.next()->counts.outside_rows == 0);
  const SensorModel own = inspect(folder.path().string(), options).sensor;
  for (std::size_t row = 0; row < 16; ++row) {
    CHECK(own.beam_elevation_rad[row] - sensor.beam_elevation_rad[row] ==
          doctest::Approx(0.8 * kTurn_rad / 360.0).epsilon(0.001));
  }
  // A sensor that is on its table keeps it, to the last bit.
  write_file(folder.file("0.txt"), firing_order(0.0, 360.0, 0.01));
  CHECK(inspect(folder.path().string(), options).sensor == sensor);
}

/// Four scans of a VLP-16 whose rings are numbered so, 0 the lowest; beams under these stay out.
void write_numbered(const TemporaryDirectory& folder, const std::function<int(int)>& number,
                    const SensorModel& sensor = sensor_preset("vlp-16"), int every = 1) {
  for (int scan = 0; scan < 4; ++scan) {
    std::string text = "x y z ring\n";
    for (int step = 0; step < 900; ++step) {
      for (int ring = 0; ring < sensor.rows(); ring += every) {
        const double elevation_rad = sensor.beam_elevation_rad[sensor.rows() - 1 - ring];
        const Eigen::Vector3d p =
            (5.0 + 0.1 * scan) * direction_of(-(step + 0.5) * kTurn_rad / 900, elevation_rad);
        text += fmt::format("{} {} {} {}\n", p.x(), p.y(), p.z(), number(ring));
      }
    }
    write_file(folder.file(std::to_string(scan) + ".txt"), text);
  }
}

TEST_CASE("rings that are numbered from 1, or in steps, are those of the sensor in their order") {
  for (const auto& [first, step] : {std::pair(1, 1), {0, 2}, {3, 4}}) {
    CAPTURE(first);
    const TemporaryDirectory folder;
    write_numbered(folder, [=](int ring) { return first + step * ring; });
    for (const std::string name : {"", "vlp-16"}) {
      auto recording = Recording::open(folder.path().string(), {.sensor = name});
      CHECK(recording.sensor().rows() == 16);
      const auto scan = recording.next();
      REQUIRE(scan);
      CHECK(scan->counts.kept > 16 * 800);
      CHECK(scan->cloud.points_m[scan->cloud.index(0, 450)].z() > 1.0F);
    }
  }
}

TEST_CASE("of a sensor of which only every fourth beam has points only those rows are read") {
  const TemporaryDirectory folder;
  write_numbered(
      folder, [](int ring) { return ring; }, sensor_preset("os1-64"), 4);
  auto recording = Recording::open(folder.path().string(), {.sensor = "os1-64"});
  CHECK(recording.sensor().rows() == 16);
  CHECK(recording.warnings().at(0).find("only rows 3, 7, ... 63 of 64") != std::string::npos);
  CHECK(recording.next()->counts.kept > 16 * 800);
}

TEST_CASE("a named sensor whose beams are those of another one is refused") {
  const TemporaryDirectory folder;
  write_numbered(folder, [](int ring) { return ring; });
  CHECK(refused_with([&] { Recording::open(folder.path().string(), {.sensor = "os1-16"}); },
                     "os1-16", "vlp-16", "name the sensor"));
}

TEST_CASE("one file of another kind among the scans is left out") {
  const TemporaryDirectory folder;
  write_numbered(folder, [](int ring) { return ring; });
  std::string odd = "x y z\n";
  for (int i = 0; i < 3000; ++i) odd += fmt::format("{} {} {}\n", i % 60, i % 7, i % 50 - 10);
  write_file(folder.file("00.txt"), odd);
  auto recording = Recording::open(folder.path().string());
  CHECK(recording.sensor().name == "vlp-16");
  LeftOut left_out;
  while (next_usable(recording, left_out)) continue;
  CHECK(left_out.scans == 1);
  CHECK(left_out.first.find("00.txt") != std::string::npos);
}

TEST_CASE("a sensor with too few columns for its points is named once") {
  const TemporaryDirectory directory;
  for (int i = 0; i < 2; ++i) {  // a point each half of a degree
    write_file(directory.file(fmt::format("{}.txt", i)), firing_order(0.0, 360.0));
  }
  SensorModel sensor = sensor_preset("vlp-16");
  for (const int columns : {1800, 720, 360}) {
    sensor.columns = columns;
    const auto source = open_scan_files(directory.path().string(), sensor,
                                        {.without_times = CaptureTime::kRolling});
    while (source->next()) continue;
    const std::vector<std::string> warnings = source->warnings();
    REQUIRE(std::ssize(warnings) == (columns == 360 ? 1 : 0));
    if (columns == 360) {
      CHECK(warnings[0].find("5760 of 11520 points kept") != std::string::npos);
      CHECK(warnings[0].find("16 x 360") != std::string::npos);
    }
  }
}

TEST_CASE("clouds that are tilted against their sensor keep its beams and cause a warning") {
  const SensorModel sensor = sensor_preset("vlp-16");
  for (const double pitch_deg : {0.0, 3.0}) {
    const TemporaryDirectory directory;
    for (int i = 0; i < 2; ++i) {
      write_file(directory.file(fmt::format("{}.txt", i)),
                 firing_order(30.0, 270.0, 0.0, pitch_deg));
    }
    const auto source = open_scan_files(directory.path().string(), sensor,
                                        {.without_times = CaptureTime::kRolling});
    while (source->next()) continue;
    CHECK(source->sensor().beam_elevation_rad == sensor.beam_elevation_rad);
    const std::vector<std::string> warnings = source->warnings();
    REQUIRE(std::ssize(warnings) == (pitch_deg > 0.0 ? 1 : 0));
    if (pitch_deg > 0.0) CHECK(one_line_with(warnings[0], "nearer to another beam"));
  }
}

TEST_CASE("a recording whose first scans all are of something else is refused") {
  const TemporaryDirectory directory;
  for (int i = 0; i < 12; ++i) write_file(directory.file(std::to_string(i) + ".txt"), "no scan\n");
  const auto source = open_scan_files(directory.path().string(), sensor_preset("vlp-16"));
  CHECK(is_given_up_at_tenth(*source));
}

TEST_CASE("confidence and intensity come with their points, whatever the field is called") {
  const TemporaryDirectory folder;
  const auto read = [&](const std::string& names) {
    write_file(folder.file("a.csv"), names + "\n1,2,0.5,3,7\n0,0,0.9,0,8\n4,5,1,6,9\n");
    return read_point_file(folder.file("a.csv")).scan;
  };
  for (const char* name : {"intensity", "Reflectivity", "scalar_Intensity"}) {
    const Scan scan = read(std::string("x,y,confidence,z,") + name);
    CHECK(scan.points_m.size() == 2);
    CHECK(scan.confidence == std::vector<float>{0.5F, 1.0F});
    CHECK(scan.intensity == std::vector<float>{7.0F, 9.0F});
  }
  CHECK(read("x,y,intensity,z,reflectivity").intensity == std::vector<float>{7.0F, 9.0F});
  CHECK(read("x,y,a,z,b").confidence.empty());
  CHECK(read("x,y,a,z,b").intensity.empty());
}

TEST_CASE("intensities that are all 0 are none") {
  const TemporaryDirectory folder;
  write_file(folder.file("a.txt"), "1 2 3 0\n2 3 4 0\n");
  CHECK(read_point_file(folder.file("a.txt")).scan.intensity.empty());
}

TEST_CASE("the unit of times is that in which they last a turn") {
  const auto last_s = [](double span, bool whole, double period_s) {
    const auto times = point_times({"t", whole, {0.0, span / 2.0, span}}, period_s, "a test");
    return times->offset_s.back();
  };
  CHECK(last_s(0.1, false, 0.1) == doctest::Approx(0.05));
  CHECK(last_s(99.0, false, 0.1) == doctest::Approx(0.0495));
  CHECK(last_s(1e8, true, 0.1) == doctest::Approx(0.05));
  CHECK(last_s(1e5, true, 0.1) == doctest::Approx(0.05));
  CHECK(last_s(5e4, true, 0.05) == doctest::Approx(0.025));
  CHECK_FALSE(point_times({"t", false, {3.0, 3.0}}, 0.1, "a test"));
  CHECK(refused_with([&] { last_s(0.2, false, 0.1); }, "a test", "'t'", "0.1 s", "0.2 s",
                     "scan_period_s"));
  CHECK(refused_with([&] { last_s(3e6, false, 1.0); }, "seconds", "3e+06 s"));
  CHECK(refused_with([&] { last_s(1.5e9, true, 1.0); }, "nanoseconds", "1.5 s"));
  CHECK(refused_with([&] { point_times({"t", false, {0.0, NAN}}, 0.1, "a test"); }, "not finite"));
  const auto clock = point_times({"t", false, {1.6e9, 1.6e9 + 0.1}}, 0.1, "a test");
  CHECK(clock->absolute);
  CHECK(clock->middle_s == doctest::Approx(1.6e9 + 0.05).epsilon(1e-15));
}
