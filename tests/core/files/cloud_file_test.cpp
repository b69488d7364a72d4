#include "hqslam/core/cloud_file.h"

#include "hqslam/core/point_fields.h"
#include "testing.h"

namespace {

Scan a_scan() {
  Scan scan;
  scan.stamp_s = 1'700'000'000.5;
  scan.points_m = {{1.0F, 2.0F, 3.0F}, {4.0F, 5.0F, -6.0F}};
  scan.row = {3, 15};
  scan.time_offset_s = {-0.05F, 0.05F};
  scan.intensity = {1.0F, 0.25F};
  scan.confidence = {1.0F, 0.5F};
  return scan;
}

}  // namespace

TEST_CASE("a cloud comes back with all that is known of its points, whatever the file") {
  const TemporaryDirectory folder;
  for (const char* name : {"a.pcd", "a.ply"}) {
    CAPTURE(name);
    write_cloud(a_scan(), folder.file(name));
    const RawPoints points = read_point_file(folder.file(name));
    CHECK(points.scan.points_m == a_scan().points_m);
    CHECK(points.scan.confidence == a_scan().confidence);
    CHECK(points.ring == std::vector<double>{3.0, 15.0});
    const Scan scan = scan_of(points, nullptr, name);
    CHECK(scan.stamp_s == doctest::Approx(a_scan().stamp_s).epsilon(1e-15));
    CHECK(scan.time_offset_s[1] == doctest::Approx(0.05));
    CHECK(points.scan.intensity == a_scan().intensity);
  }
}

TEST_CASE("what is not known has no field; a file that gets its name at the end is of its kind") {
  const TemporaryDirectory folder;
  Scan scan;
  scan.points_m = a_scan().points_m;
  write_cloud(scan, folder.file("a.pcd"));
  CHECK(file_contents(folder.file("a.pcd")).find("FIELDS x y z\n") != std::string::npos);
  write_cloud(a_scan(), folder.file("a.ply.part"));
  CHECK(file_contents(folder.file("a.ply.part")).starts_with("ply\n"));
}

TEST_CASE("a cloud that cannot be written is an error of one line") {
  Scan scan = a_scan();
  CHECK(refused_with([&] { write_cloud(scan, "/tmp/cloud.las"); }, "cloud.las", ".ply"));
  CHECK(refused_with([&] { write_cloud(scan, "/nowhere/a.ply"); }, "/nowhere/a.ply", "written"));
  scan.intensity.pop_back();
  CHECK(refused_with([&] { write_cloud(scan, "/nowhere/a.pcd"); }, "'intensity'", "2 points"));
}
