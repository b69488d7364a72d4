#include "hqslam/core/cloud_file.h"
#include "hqslam/core/point_fields.h"
#include "hqslam/slam/dense_map.h"
#include "testing.h"

using namespace hqslam::slam;

namespace {

const std::vector<DenseMapPoint> kPoints = {{{1.0F, 2.0F, 3.0F}, 0.75F, 4},
                                            {{-1.5F, 0.25F, 0.0F}, 0.5F, 70000}};

}  // namespace

TEST_CASE("a .pcd map reads back, with its confidences and counts behind the coordinates") {
  const TemporaryDirectory folder;
  write_dense_map(kPoints, folder.file("map.pcd"));
  const Scan scan = read_cloud(folder.file("map.pcd"));
  REQUIRE(scan.points_m.size() == 2);
  CHECK(scan.points_m[1] == kPoints[1].point_m);
  const std::string bytes = file_contents(folder.file("map.pcd"));
  CHECK(bytes.find("FIELDS x y z confidence times_seen") != std::string::npos);
  std::uint32_t seen = 0;
  std::memcpy(&seen, bytes.data() + bytes.size() - 4, 4);
  CHECK(seen == 70000);
}

TEST_CASE("a .ply map has the header of the format and 20 bytes for each point") {
  const TemporaryDirectory folder;
  write_dense_map(kPoints, folder.file("map.ply"));
  const std::string bytes = file_contents(folder.file("map.ply"));
  CHECK(bytes.starts_with("ply\nformat binary_little_endian 1.0\n"));
  CHECK(bytes.find("element vertex 2\n") != std::string::npos);
  const std::size_t body = bytes.find("end_header\n") + 11;
  REQUIRE(bytes.size() == body + 40);
  float confidence = 0.0F;
  std::memcpy(&confidence, bytes.data() + body + 12, 4);
  CHECK(confidence == 0.75F);
}

TEST_CASE("a map's intensities stand before its confidences") {
  const TemporaryDirectory folder;
  for (const char* name : {"map.pcd", "map.ply"}) {
    write_dense_map(kPoints, folder.file(name), {300.0F, 0.0F});
    const Scan scan = read_point_file(folder.file(name)).scan;
    CHECK(scan.intensity == std::vector<float>{300.0F, 0.0F});
    CHECK(scan.confidence == std::vector<float>{0.75F, 0.5F});
  }
}

TEST_CASE("a map that cannot be written is an error of one line") {
  CHECK(refused_with([] { write_dense_map(kPoints, "/nowhere/map.ply"); }, "/nowhere/map.ply",
                     "cannot be written"));
  CHECK(refused_with([] { write_dense_map(kPoints, "/nowhere/map.ply", {1.0F}); },
                     "expected 2 intensities, one per point, found 1"));
}
