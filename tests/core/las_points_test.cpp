#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "error_message.h"
#include "file_contents.h"
#include "hqslam/core/cloud_file.h"
#include "hqslam/core/point_fields.h"
#include "temporary_directory.h"

using namespace hqslam;
using namespace hqslam::test;

namespace {

/// A file by the specification's tables of bytes.
struct ByHand {
  std::string bytes;

  template <typename T>
  ByHand& at(std::size_t offset, T value) {
    if (bytes.size() < offset + sizeof(T)) bytes.resize(offset + sizeof(T), '\0');
    std::memcpy(bytes.data() + offset, &value, sizeof(T));
    return *this;
  }
  ByHand& text(std::size_t offset, const std::string& value) {
    for (std::size_t i = 0; i < value.size(); ++i) at(offset + i, value[i]);
    return *this;
  }
};

/// Without records: the points begin behind the header.
ByHand header(int minor, std::uint8_t format, std::uint16_t point_bytes, std::uint32_t points) {
  const std::uint16_t bytes = minor == 4 ? 375 : 227;
  ByHand file;
  file.text(0, "LASF").at<std::uint8_t>(24, 1).at(25, static_cast<std::uint8_t>(minor));
  file.at(94, bytes).at<std::uint32_t>(96, bytes);
  file.at(104, format).at(105, point_bytes).at(107, points).at(111, points);
  for (const std::size_t scale : {131U, 139U, 147U}) file.at(scale, 0.001);
  file.at(std::size_t{bytes} - 1U, '\0').at(219, 0.0);
  return file;
}

/// Two points of format 1 with a time each, and a confidence in the extra bytes of one record.
ByHand two_points() {
  ByHand file = header(2, 1, 32, 2);
  file.text(26, "hqslam").text(58, "hqslam");
  file.at<std::uint32_t>(96, 227 + 54 + 192).at<std::uint32_t>(100, 1);
  const double box[] = {1.5, -0.25, 2.0, -3.0, 0.125, 0.0};  // x to, x from, y ...
  for (std::size_t i = 0; i < 6; ++i) file.at(179 + 8 * i, box[i]);
  file.text(227 + 2, "LASF_Spec").at<std::uint16_t>(227 + 18, 4).at<std::uint16_t>(227 + 20, 192);
  file.at<std::uint8_t>(281 + 2, 9).text(281 + 4, "confidence").at(281 + 191, '\0');
  const std::size_t a = 473, b = 505;
  file.at<std::int32_t>(a, 1500).at<std::int32_t>(a + 4, -3000).at<std::int32_t>(a + 8, 125);
  file.at<std::uint16_t>(a + 12, 257 * 200).at<std::uint8_t>(a + 14, 9).at(a + 20, 1000.25);
  file.at(a + 28, 1.0F);
  file.at<std::int32_t>(b, -250).at<std::int32_t>(b + 4, 2000).at<std::int32_t>(b + 8, 0);
  file.at<std::uint16_t>(b + 12, 0).at<std::uint8_t>(b + 14, 9).at(b + 20, 999.75);
  file.at(b + 28, 0.5F);
  return file;
}

RawPoints points_of(const ByHand& file, const char* name = "a.las") {
  const TemporaryDirectory folder;
  write_file(folder.file(name), file.bytes);
  return read_point_file(folder.file(name));
}

std::string las_complaint(const ByHand& file, const char* name = "a.las") {
  return error_message([&] { points_of(file, name); });
}

const Scan& two_point_scan() {
  static const Scan scan = [] {
    Scan points;
    points.stamp_s = 1000.0;
    points.points_m = {{1.5F, -3.0F, 0.1251F}, {-0.25F, 2.0F, 0.0F}};
    points.time_offset_s = {0.25F, -0.25F};
    points.intensity = {200.0F, std::nanf("")};
    points.confidence = {1.0F, 0.5F};
    return points;
  }();
  return scan;
}

}  // namespace

TEST_CASE("a .las file is what the specification's tables of bytes say") {
  const TemporaryDirectory folder;
  write_cloud(two_point_scan(), folder.file("a.las"));
  CHECK(file_contents(folder.file("a.las")) == two_points().bytes);
}

TEST_CASE("points of a .las file come with intensity, time, and extra bytes by their names") {
  const RawPoints points = points_of(two_points());
  CHECK(points.scan.points_m ==
        std::vector<Eigen::Vector3f>{{1.5F, -3.0F, 0.125F}, {-0.25F, 2.0F, 0.0F}});
  CHECK(points.scan.intensity == std::vector<float>{51400.0F, 0.0F});
  CHECK(points.scan.confidence == std::vector<float>{1.0F, 0.5F});
  CHECK(points.time.values == std::vector<double>{1000.25, 999.75});
}

TEST_CASE("point formats 0 to 3 and 6 to 8 are read, with the header's scales and offsets") {
  const std::uint16_t bytes[] = {20, 28, 26, 34, 0, 0, 30, 36, 38};
  constexpr std::uint8_t kFormats[] = {0, 1, 2, 3, 6, 7, 8};
  for (const std::uint8_t format : kFormats) {
    CAPTURE(int{format});
    ByHand file = header(4, format, bytes[format], format > 5 ? 0 : 1);
    if (format > 5) file.at<std::uint64_t>(247, 1);
    file.at(131, 0.5).at(155, 100.0);
    file.at<std::int32_t>(375, 7).at<std::uint16_t>(375 + 12, 9).at(375 + bytes[format] - 1, '\0');
    if (format == 1 || format == 3) file.at(375 + 20, 12.5);
    if (format > 5) file.at(375 + 22, 12.5);
    const RawPoints points = points_of(file);
    REQUIRE(points.scan.points_m.size() == 1);
    CHECK(points.scan.points_m[0] == Eigen::Vector3f(103.5F, 0.0F, 0.0F));
    CHECK(points.scan.intensity == std::vector<float>{9.0F});
    const bool has_time = format % 2 == 1 || format > 5;
    CHECK(points.time.values == (has_time ? std::vector<double>{12.5} : std::vector<double>{}));
  }
}

TEST_CASE("intensities are stretched to 16 bits by the range that they are of") {
  const auto stored = [](float largest) {
    const TemporaryDirectory folder;
    Scan scan;
    scan.points_m.assign(2, {1.0F, 2.0F, 3.0F});
    scan.intensity = {0.5F, largest};
    write_cloud(scan, folder.file("a.las"));
    return read_point_file(folder.file("a.las")).scan.intensity;
  };
  CHECK(stored(1.0F) == std::vector<float>{32768.0F, 65535.0F});
  CHECK(stored(100.0F) == std::vector<float>{129.0F, 25700.0F});
  CHECK(stored(3000.0F) == std::vector<float>{1.0F, 3000.0F});
  CHECK(stored(131070.0F) == std::vector<float>{0.0F, 65535.0F});
}

TEST_CASE("what is no .las file is an error of one line") {
  CHECK(one_line_with(las_complaint(two_points(), "a.laz"), "a.laz", "LAZ"));
  CHECK(one_line_with(las_complaint(two_points().at<std::uint8_t>(104, 129)), "a.las", "LAZ"));
  CHECK(one_line_with(las_complaint(two_points().at<std::uint8_t>(104, 4)), "format", "found 4"));
  CHECK(one_line_with(las_complaint(two_points().at<std::uint8_t>(24, 2)), "version"));
  CHECK(one_line_with(las_complaint(two_points().text(0, "LAZF")), "LASF"));
  ByHand file = two_points();
  file.bytes.resize(200);
  CHECK(one_line_with(las_complaint(file), "truncated"));
  file = two_points();
  file.bytes.pop_back();
  CHECK(one_line_with(las_complaint(file), "found 2 points"));
  CHECK(one_line_with(las_complaint(two_points().at<std::uint32_t>(107, 4'000'000'000)),
                      "4000000000 points"));
  CHECK(one_line_with(las_complaint(two_points().at<std::uint16_t>(105, 0)), "of 0 bytes"));
  CHECK(one_line_with(las_complaint(two_points().at<std::uint32_t>(96, 4'000'000'000)),
                      "at byte 4000000000"));
  CHECK(one_line_with(las_complaint(two_points().at(155, 412345.0)), "100 km", "412346.5 m"));
  CHECK(one_line_with(las_complaint(two_points().at(131, std::nan(""))), "100 km"));
}

TEST_CASE("records that describe extra bytes beyond a point's, or scaled ones, are passed over") {
  CHECK(points_of(two_points().at<std::uint8_t>(281 + 2, 10)).scan.confidence.empty());
  CHECK(points_of(two_points().at<std::uint8_t>(281 + 2, 77)).scan.confidence.empty());
  CHECK(points_of(two_points().at<std::uint8_t>(281 + 3, 8)).scan.confidence.empty());
  CHECK(points_of(two_points().at<std::uint16_t>(227 + 20, 65535)).scan.confidence.size() == 2);
}

TEST_CASE("what a .las file cannot hold is an error before anything is written") {
  const TemporaryDirectory folder;
  Scan scan = two_point_scan();
  for (const float x_m : {3e6F, std::numeric_limits<float>::quiet_NaN()}) {
    scan.points_m[0].x() = x_m;
    CHECK(one_line_with(error_message([&] { write_cloud(scan, folder.file("a.las")); }), "a.las",
                        "2,147,483 m"));
  }
}
