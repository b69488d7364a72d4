#include "files/point_files.h"
#include "hqslam/core/cloud_file.h"
#include "testing.h"

using Points = std::vector<Eigen::Vector3f>;

namespace {

std::string header(const std::string& fields, const std::string& size, const std::string& type,
                   int points, const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + size + "\nTYPE " + type +
         "\nWIDTH " + std::to_string(points) + "\nHEIGHT 1\nPOINTS " + std::to_string(points) +
         "\nDATA " + data + "\n";
}

/// sensor: as read_cloud.
Scan scan_of(const std::string& contents, const auto&... sensor) {
  return from_file("0.pcd", contents, [&](auto&& path) { return read_cloud(path, sensor...); });
}

void refuses_pcd(const std::string& contents, const auto&... parts) {
  CHECK(refused_with([&] { scan_of(contents); }, parts...));
}

std::string literals(const std::string& bytes) {
  std::string stream;
  for (std::size_t i = 0; i < bytes.size(); i += 32) {
    const std::string chunk = bytes.substr(i, 32);
    stream += static_cast<char>(chunk.size() - 1);
    stream += chunk;
  }
  return raw_bytes(static_cast<std::uint32_t>(stream.size()),
                   static_cast<std::uint32_t>(bytes.size())) +
         stream;
}

const std::string kAscii = header("x y z", "4 4 4", "F F F", 2, "ascii") + "1 2 3\n-4 5.5 6e-1\n";

struct Ring {
  double elevation_rad;
  int number;
};

/// A file with as many points of each ring.
std::string points_of_rings(const std::vector<Ring>& rings, int of_each) {
  const int points = of_each * static_cast<int>(rings.size());
  std::string contents = header("x y z ring", "4 4 4 2", "F F F U", points, "ascii");
  for (const Ring& ring : rings) {
    const std::string point = "10 0 " + std::to_string(10.0 * std::tan(ring.elevation_rad)) + " " +
                              std::to_string(ring.number) + "\n";
    for (int i = 0; i < of_each; ++i) contents += point;
  }
  return contents;
}

/// Points on each beam, with its ring number as the driver counts.
std::string points_on_beams(const SensorModel& sensor, bool ring_0_is_highest, int of_each = 1) {
  std::vector<Ring> rings;
  for (int row = 0; row < sensor.rows(); ++row) {
    rings.push_back(
        {sensor.beam_elevation_rad[row], ring_0_is_highest ? row : sensor.rows() - 1 - row});
  }
  return points_of_rings(rings, of_each);
}

std::string stream(std::initializer_list<int> bytes) {
  std::string result;
  for (const int byte : bytes) result += static_cast<char>(byte);
  return result;
}

}  // namespace

TEST_CASE("an ascii file is read, with or without COUNT") {
  const std::string counted =
      "VERSION 0.7\nFIELDS i x y z\nSIZE 1 8 4 4\nTYPE U F F F\n"
      "COUNT 2 1 1 1\nWIDTH 1\nHEIGHT 2\nDATA ascii\n"
      "7 7 1 2 3\r\n7 7\t-4 5.5 0.6";
  for (const std::string& contents : {kAscii, counted}) {
    const Scan scan = scan_of(contents);
    CHECK(scan.points_m == Points{{1, 2, 3}, {-4, 5.5F, 0.6F}});
    CHECK(scan.row.empty());
    CHECK(scan.time_offset_s.empty());
  }
}

TEST_CASE("a binary file with fields of every type in any order, and of no points, is read") {
  auto contents = header("intensity z ring y t x", "1 8 2 4 4 8", "U F U F U F", 2, "binary");
  contents += raw_bytes<std::uint8_t, double, std::uint16_t>(9, 3.0, 1, 2.0F, 0U, 1.0);
  contents += raw_bytes<std::uint8_t, double, std::uint16_t>(9, 6.0, 0, 5.0F, 100'000'000U, 4.0);
  const Scan scan = scan_of(contents);
  CHECK(scan.points_m == Points{{1, 2, 3}, {4, 5, 6}});
  REQUIRE(scan.time_offset_s.size() == 2);
  CHECK(scan.time_offset_s[0] == doctest::Approx(-0.05));
  CHECK(scan.time_offset_s[1] == doctest::Approx(0.05));
  contents = header("x y z w", "1 2 8 4", "I I I U", 1, "binary");
  contents += raw_bytes<std::int8_t, std::int16_t, std::int64_t>(-1, -300, 70000, 1U);
  CHECK(scan_of(contents).points_m == Points{{-1, -300, 70000}});
  CHECK(scan_of(header("x y z ring", "4 4 4 2", "F F F U", 0, "binary")).points_m.empty());
}

TEST_CASE("a compressed file holds its fields one after the other") {
  const Scan scan = scan_of(header("x y z", "4 4 4", "F F F", 2, "binary_compressed") +
                            literals(raw_bytes({1, 4, 2, 5, 3, 6})));
  CHECK(scan.points_m == Points{{1, 2, 3}, {4, 5, 6}});
}

TEST_CASE("points of a good file that are not finite or at the origin are counted and left out") {
  const Scan scan = scan_of(header("x y z t", "4 4 4 4", "F F F F", 5, "ascii") +
                            "nan nan nan 0\n0 0 0 0.01\n1 2 3 0.02\n1 2 inf 0.03\n1 2 4 0.04\n");
  CHECK(scan.points_m.size() == 2);
  CHECK(scan.invalid_points == 3);
  REQUIRE(scan.time_offset_s.size() == 2);
  CHECK(scan.time_offset_s[1] == doctest::Approx(0.01));
}

TEST_CASE("times are offsets from the middle of the scan, whatever they count from") {
  const std::string rows = "1 0 0 1700000000.00\n2 0 0 1700000000.06\n3 0 0 1700000000.10\n";
  const Scan scan = scan_of(header("x y z timestamp", "4 4 4 8", "F F F F", 3, "ascii") + rows);
  REQUIRE(scan.time_offset_s.size() == 3);
  CHECK(scan.time_offset_s[0] == doctest::Approx(-0.05).epsilon(1e-4));
  CHECK(scan.time_offset_s[1] == doctest::Approx(0.01).epsilon(1e-4));
  CHECK(scan_of(header("x y z time", "4 4 4 4", "F F F F", 2, "ascii") + "1 0 0 0\n2 0 0 0\n")
            .time_offset_s.empty());
}

TEST_CASE("row 0 is the highest beam whether the driver counts rings from above or from below") {
  for (const std::string& name : sensor_preset_names()) {
    CAPTURE(name);
    const SensorModel sensor = sensor_preset(name);
    for (const bool ring_0_is_highest : {true, false}) {
      const Scan scan = scan_of(points_on_beams(sensor, ring_0_is_highest), sensor);
      REQUIRE(static_cast<int>(scan.row.size()) == sensor.rows());
      CHECK(scan.row.front() == 0);
      CHECK(scan.row.back() == sensor.rows() - 1);
    }
  }
}

TEST_CASE("rings in the order of firing or all alike are left to the elevation") {
  const SensorModel sensor = sensor_preset("vlp-16");
  std::vector<Ring> firing;
  std::vector<Ring> alike;
  for (int row = 0; row < 16; ++row) {
    // A VLP-16 fires -15, 1, -13, 3, ... degrees.
    firing.push_back({sensor.beam_elevation_rad[row], row < 8 ? 15 - 2 * row : 30 - 2 * row});
    alike.push_back({sensor.beam_elevation_rad[row], 0});
  }
  for (const auto& rings : {firing, alike}) {
    CHECK(scan_of(points_of_rings(rings, 1), sensor).row.empty());
  }
}

TEST_CASE("rings of a sensor with more or fewer beams are not taken for those of this one") {
  const SensorModel sensor = sensor_preset("vlp-16");
  const std::string more = points_on_beams(sensor_preset("hdl-32e"), true);
  CHECK(refused_with([&] { scan_of(more, sensor); }, "0.pcd", "'ring'", "0 to 15", "vlp-16",
                     "found 16"));
  for (const bool ring_0_is_highest : {false, true}) {
    const std::string contents = points_on_beams(sensor, ring_0_is_highest, 100);
    CHECK(scan_of(contents, sensor).row.size() == 1600);
    for (const char* other : {"os1-64", "hdl-64e", "hdl-32e", "vls-128"}) {
      CAPTURE(other);
      CHECK(refused_with([&] { scan_of(contents, sensor_preset(other)); }, "'ring'", "16 rings",
                         "name the sensor"));
    }
  }
}

TEST_CASE("some rings of a sensor, its own or a little off, are taken as they are") {
  const SensorModel sensor = sensor_preset("os1-64");
  std::vector<Ring> rings;
  for (int row = 3; row < 64; row += 4)
    rings.push_back({sensor.beam_elevation_rad[row] + 0.03, row});
  const Scan scan = scan_of(points_of_rings(rings, 100), sensor);
  REQUIRE(scan.row.size() == 1600);
  CHECK(scan.row.front() == 3);
  CHECK(scan.row.back() == 63);
}

TEST_CASE("a file that is no point cloud is refused with file, expected and found") {
  const auto refuses = [](const std::string& from, const std::string& to, const auto&... parts) {
    CAPTURE(to);
    refuses_pcd(replaced_in(kAscii, from, to), parts...);
  };
  refuses_pcd("", "0.pcd", "DATA");
  refuses_pcd("ply\nformat ascii\n", "0.pcd", "DATA", "found 'ply'");
  refuses("FIELDS x y z", "FIELDS x y w", "fields x y z", "found x y w");
  refuses("SIZE 4 4 4", "SIZE 4 4", "SIZE", "expected 3", "found 2");
  refuses("SIZE 4 4 4", "SIZE 4 4 3", "'z'", "F of 3");
  refuses("TYPE F F F", "TYPE F F Q", "'z'", "Q of 4");
  refuses("TYPE F F F\n", "", "line TYPE");
  refuses("WIDTH 2", "WIDTH -2", "WIDTH", "'-2'");
  refuses("WIDTH 2", "WIDTH 3", "POINTS", "3 x 1", "found 2");
  refuses("DATA ascii", "DATA base64", "'base64'", "binary_compressed");
  refuses("5.5", "five", "point 1", "'five'");
  refuses(" 6e-1\n", "", "truncated", "2 points of 3", "found 5");
  refuses("DATA ascii", "DATA binary", "truncated", "2 points of 12 bytes");
  refuses_pcd(header("x y z", "4 4 4", "F F F", 2, "binary") + "abc", "truncated", "found 3 bytes");
  CHECK(refused_with([] { read_cloud("/nowhere/0.pcd"); }, "/nowhere", "no file"));
}

TEST_CASE("counts that overflow or exceed the file are refused before anything is allocated") {
  const auto refuses = [](const std::string& rest, const auto&... parts) {
    CAPTURE(rest);
    refuses_pcd("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n" + rest, parts...);
  };
  for (const char* data : {"ascii", "binary", "binary_compressed"}) {
    refuses(std::string("WIDTH 67108864\nHEIGHT 1\nDATA ") + data + "\n1 2 3\n", "truncated");
  }
  refuses("WIDTH 4294967296\nHEIGHT 4294967296\nDATA ascii\n1 2 3\n", "WIDTH", "up to 67108864");
  refuses("WIDTH 67108864\nHEIGHT 2\nDATA ascii\n1 2 3\n", "POINTS", "67108864 x 2");
  refuses("COUNT 0 1 1\nWIDTH 1\nHEIGHT 1\nDATA binary\n12345678", "'x'", "found none");
  const std::string wide =
      "FIELDS x y z pad\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 13\nWIDTH 25165824\nHEIGHT 1\n"
      "DATA binary_compressed\n";
  const std::string sizes = raw_bytes(0U, 64U * 25165824U);
  refuses_pcd(wide + sizes, "0.pcd", "at most 1073741824 bytes", "found 1610612736");
}

TEST_CASE("coordinates that no double holds are refused, not taken as 0") {
  for (const std::string number : {"1e400", "-1e400", "1e-400"}) {
    refuses_pcd(header("x y z", "4 4 4", "F F F", 1, "ascii") + "5 " + number + " 1\n", "point 0",
                "expected a number", number);
  }
}

TEST_CASE("damaged compressed data are refused") {
  const std::string data(24, 'a');
  const std::string start = header("x y z", "4 4 4", "F F F", 2, "binary_compressed");
  std::string stream = literals(data);
  refuses_pcd(start + stream.substr(0, 20), "truncated");
  refuses_pcd(start + "ab", "truncated");
  refuses_pcd(start + literals(std::string(23, 'a')), "found 23 bytes");
  stream[8] = '\xFF';
  refuses_pcd(start + stream, "damaged");
}

TEST_CASE("literals, short and long references and overlapping repeats are expanded") {
  CHECK(lzf_decompressed("", 0) == "");
  CHECK(lzf_decompressed(stream({2, 'a', 'b', 'c'}), 3) == "abc");
  // Repeat 3 bytes from 3 back.
  CHECK(lzf_decompressed(stream({2, 'a', 'b', 'c', 1 << 5, 2}), 6) == "abcabc");
  // Repeat 5 bytes from 1 back: the output feeds itself.
  CHECK(lzf_decompressed(stream({0, 'x', 3 << 5, 0}), 6) == "xxxxxx");
  // A long repeat: 9 + 255 bytes from 1 back, the longest there is.
  CHECK(lzf_decompressed(stream({0, 'y', 7 << 5, 255, 0}), 265) == std::string(265, 'y'));
  // A distance of more than 256: 300 bytes of literals, then 3 from 300 back.
  std::string literals;
  std::string plain;
  for (int i = 0; i < 300; i += 30) {
    literals += stream({29}) + std::string(30, static_cast<char>('a' + i / 30));
    plain += std::string(30, static_cast<char>('a' + i / 30));
  }
  CHECK(lzf_decompressed(literals + stream({(1 << 5) | 1, 43}), 303) == plain + "aaa");
}

TEST_CASE("a damaged stream gives nothing instead of reading or writing out of bounds") {
  CHECK_FALSE(lzf_decompressed(stream({2, 'a', 'b'}), 3));             // literal cut short
  CHECK_FALSE(lzf_decompressed(stream({2, 'a', 'b', 'c'}), 2));        // more than promised
  CHECK_FALSE(lzf_decompressed(stream({2, 'a', 'b', 'c'}), 4));        // less than promised
  CHECK_FALSE(lzf_decompressed(stream({0, 'x', 1 << 5, 1}), 4));       // before the beginning
  CHECK_FALSE(lzf_decompressed(stream({0, 'x', 1 << 5}), 4));          // reference cut short
  CHECK_FALSE(lzf_decompressed(stream({0, 'x', 7 << 5, 0}), 10));      // long reference cut short
  CHECK_FALSE(lzf_decompressed(stream({0, 'x', 7 << 5, 255, 0}), 9));  // repeat beyond the end
  CHECK_FALSE(lzf_decompressed("", 1));
  CHECK_FALSE(lzf_decompressed("abc", std::size_t{1} << 60U));  // no allocation
}
