#include "hqslam/core/cloud_file.h"
#include "vlp16_files.h"

using namespace hqslam::recordings;

// Point files beyond .bin and .pcd: their forms, and what their fields are.

namespace {

RecordedScan only_scan(const std::string& path) {
  const auto source = open_scan_files(path, sensor_preset("vlp-16"));
  REQUIRE(source->size() == 1);
  return *source->next();
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
  const RecordedScan csv = only_scan(directory.file("a.csv"));
  const RecordedScan txt = only_scan(directory.file("b.txt"));
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
    const RecordedScan scan = only_scan(directory.file("a.csv"));
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
  binary += raw_bytes<float, double, float, std::uint8_t>(5, 0, 0.2616F, 9, 0U);
  binary += raw_bytes<float, double, float, std::uint8_t>(5, 0, -1.1507F, 1, 50'000'000U);
  binary += raw_bytes<float, double, float, std::uint8_t>(5, 0, 1.33975F, 15, 90'000'000U);
  write_file(directory.file("b.ply"), binary);
  const RecordedScan ascii = only_scan(directory.file("a.ply"));
  const RecordedScan packed = only_scan(directory.file("b.ply"));
  CHECK(ascii.counts.kept == 3);
  CHECK(ascii.cloud.range_m == packed.cloud.range_m);
  CHECK(ascii.cloud.time_offset_s == packed.cloud.time_offset_s);
  CHECK(ascii.cloud.time_offset_s[ascii.cloud.index(0, sensor.column_of_azimuth(0.0))] ==
        doctest::Approx(0.045));
}

TEST_CASE("a .ply file may announce as many points as a map has, if it is as long") {
  const auto refuses = [](const std::string& points, const auto&... parts) {
    const std::string ply =
        "ply\nformat binary_little_endian 1.0\nelement vertex " + points +
        "\nproperty float x\nproperty float y\nproperty float z\nend_header\n123";
    CHECK(refused_with([&] { from_file("map.ply", ply, only_scan); }, parts...));
  };
  refuses("60000000", "60000000 points of 12 bytes", "'3 bytes'");
  refuses("67108865", "a number of points up to 67108864");
}

TEST_CASE("confidence and intensity come with their points, whatever the field is called") {
  const auto scan_at = [](const auto& path) { return read_point_file(path).scan; };
  const auto read = [&](const std::string& names) {
    return from_file("a.csv", names + "\n1,2,0.5,3,7\n0,0,0.9,0,8\n4,5,1,6,9\n", scan_at);
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
  // Intensities that are all 0 count as absent.
  CHECK(from_file("a.txt", "1 2 3 0\n2 3 4 0\n", scan_at).intensity.empty());
}

TEST_CASE("the unit of times is that in which they last a turn") {
  const auto last_s = [](double span, bool whole, double period_s) {
    return point_times({"t", whole, {0.0, span / 2.0, span}}, period_s, "a test")->offset_s.back();
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
