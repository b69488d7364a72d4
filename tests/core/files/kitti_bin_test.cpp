#include "hqslam/core/kitti_bin.h"

#include "testing.h"

using namespace hqslam;
using namespace hqslam::test;

namespace {

std::string kitti_bin_complaint(const std::string& contents) {
  const TemporaryDirectory directory;
  write_file(directory.file("0.bin"), contents);
  return error_message([&] { read_kitti_bin(directory.file("0.bin")); });
}

}  // namespace

TEST_CASE("a KITTI scan is x y z intensity in float32") {
  const TemporaryDirectory directory;
  write_file(directory.file("0.bin"), raw_bytes({1, 2, 3, 0.5F, -4, 5.5F, -6, 0}));
  const Scan scan = read_kitti_bin(directory.file("0.bin"));
  CHECK(scan.points_m == std::vector<Eigen::Vector3f>{{1, 2, 3}, {-4, 5.5F, -6}});
  CHECK(scan.intensity == std::vector<float>{0.5F, 0.0F});
  CHECK(scan.row.empty());
  CHECK(scan.time_offset_s.empty());
  CHECK(scan.invalid_points == 0);
}

TEST_CASE(
    "points of a good KITTI scan that are not finite or at the origin are counted and left out") {
  const TemporaryDirectory directory;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  write_file(directory.file("0.bin"),
             raw_bytes({1, 2, 3, 0, nan, 2, 3, 0, 1, -inf, 3, 0, 0, 0, 0, 7, 0, 0, 3, nan}));
  const Scan scan = read_kitti_bin(directory.file("0.bin"));
  CHECK(scan.points_m.size() == 2);
  CHECK(scan.invalid_points == 3);
}

TEST_CASE("a scan written as KITTI comes back point by point") {
  const TemporaryDirectory directory;
  Scan scan;
  for (float x = 1.0F; x < 100.0F; x += 1.0F) scan.points_m.emplace_back(x, -0.3F * x, 1e-3F * x);
  write_kitti_bin(scan, directory.file("0.bin"));
  CHECK(file_contents(directory.file("0.bin")).size() == 99 * 16);
  CHECK(read_kitti_bin(directory.file("0.bin")).points_m == scan.points_m);
}

TEST_CASE("a file that is no KITTI scan is refused with file, expected and found") {
  CHECK(one_line_with(kitti_bin_complaint(""), "0.bin", "expected a KITTI scan", "empty"));
  std::string nuscenes;
  for (int i = 0; i < 400; ++i) {
    nuscenes +=
        raw_bytes(1.5F, 0.1F * static_cast<float>(i), 2.0F, 7.0F, static_cast<float>(i % 32));
  }
  CHECK(one_line_with(kitti_bin_complaint(nuscenes), "5 numbers a point (20 bytes)", "nuScenes"));
  CHECK(one_line_with(kitti_bin_complaint("1.0 2.0 3.0 0.5\n4.0 5.0"), "0.bin", "float32", "text"));
  CHECK(one_line_with(kitti_bin_complaint(raw_bytes({1, 2, 3, 0}) + "xyz"), "16 bytes per point",
                      "19 bytes", "3 too many"));
  CHECK(one_line_with(kitti_bin_complaint(raw_bytes({1e20F, 2, 3, 0, 1, 2, 3, 0})), "metres",
                      "1 of 2"));
  CHECK(refused_with([] { read_kitti_bin("/nowhere/0.bin"); }, "/nowhere/0.bin", "no file"));
  CHECK(refused_with([] { read_kitti_bin("/tmp"); }, "/tmp", "folder"));
  CHECK(refused_with([] { write_kitti_bin({}, "/nowhere/0.bin"); }, "/nowhere"));
}
