#include "hqslam/core/kitti_bin.h"

#include "testing.h"

namespace {

Scan kitti_scan(const std::string& contents) {
  return from_file("0.bin", contents, read_kitti_bin);
}

}  // namespace

TEST_CASE("a KITTI scan is x y z intensity in float32") {
  const Scan scan = kitti_scan(raw_bytes({1, 2, 3, 0.5F, -4, 5.5F, -6, 0}));
  CHECK(scan.points_m == std::vector<Eigen::Vector3f>{{1, 2, 3}, {-4, 5.5F, -6}});
  CHECK(scan.intensity == std::vector<float>{0.5F, 0.0F});
  CHECK(scan.row.empty());
  CHECK(scan.time_offset_s.empty());
  CHECK(scan.invalid_points == 0);
}

TEST_CASE("points of a KITTI scan that are not finite or at the origin are counted and left out") {
  const float nan = std::nanf("");
  const Scan scan = kitti_scan(
      raw_bytes({1, 2, 3, 0, nan, 2, 3, 0, 1, -HUGE_VALF, 3, 0, 0, 0, 0, 7, 0, 0, 3, nan}));
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
  const auto refuses = [](const std::string& contents, const auto&... parts) {
    CHECK(refused_with([&] { kitti_scan(contents); }, parts...));
  };
  refuses("", "0.bin", "expected a KITTI scan", "empty");
  std::string nuscenes;
  for (int i = 0; i < 400; ++i) {
    nuscenes +=
        raw_bytes(1.5F, 0.1F * static_cast<float>(i), 2.0F, 7.0F, static_cast<float>(i % 32));
  }
  refuses(nuscenes, "5 numbers a point (20 bytes)", "nuScenes");
  refuses("1.0 2.0 3.0 0.5\n4.0 5.0", "0.bin", "float32", "text");
  refuses(raw_bytes({1, 2, 3, 0}) + "xyz", "16 bytes per point", "19 bytes", "3 too many");
  refuses(raw_bytes({1e20F, 2, 3, 0, 1, 2, 3, 0}), "metres", "1 of 2");
  CHECK(refused_with([] { read_kitti_bin("/nowhere/0.bin"); }, "/nowhere/0.bin", "no file"));
  CHECK(refused_with([] { read_kitti_bin("/tmp"); }, "/tmp", "folder"));
  CHECK(refused_with([] { write_kitti_bin({}, "/nowhere/0.bin"); }, "/nowhere"));
}
