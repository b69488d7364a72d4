#include "made_images.h"
#include "points_file.h"
#include "tools/program/program.h"

namespace hqslam::test {
namespace {

/// A row of what evaluate-map prints.
struct MapRow {
  double points, accuracy_01, accuracy_02, far, complete_01, complete_02, f1_01, f1_02;
  std::string rest;
};

std::vector<MapRow> rows_of(const std::string& text) {
  std::vector<MapRow> rows;
  std::istringstream lines(text);
  std::string line;
  for (int i = 0; std::getline(lines, line); ++i) {
    if (i < 3) continue;
    std::istringstream words(line);
    MapRow row;
    words >> row.points >> row.accuracy_01 >> row.accuracy_02 >> row.far >> row.complete_01 >>
        row.complete_02 >> row.f1_01 >> row.f1_02;
    std::getline(words, row.rest);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

TEST_CASE("an upsampled drive's dense map is more complete than a measured one's, nearly as true") {
  const TemporaryDirectory out;
  const std::string folder = out.path();
  const auto run = [&](const char* options, const char* name) {
    const ProgramResult result =
        succeeds("run '{}' {} --dense-map --out '{}/{}'", drive_of_64(), options, folder, name);
    CHECK(holds(result.out, "dense map: "));
    const std::string of_map = fmt::format("{}/{}/dense_map", folder, name);
    const Scan map = read_cloud(of_map + ".pcd");
    CHECK(map.intensity.size() == map.points_m.size());
    CHECK(holds(file_contents(of_map + ".ply"),
                fmt::format("element vertex {}\n", map.points_m.size())));
    CHECK(holds(file_contents(fmt::format("{}/{}/report.html", folder, name)),
                R"("name":"dense map")"));
  };
  run("--rows 16", "rows16");
  run("--upsample inverse", "upsampled");
  run("", "rows64");
  const ProgramResult map = succeeds("map '{0}' --rows 16 --poses '{0}/truth.tum' --out '{1}/true'",
                                     drive_of_64(), folder);
  const ProgramResult result = succeeds(
      "evaluate-map '{0}/rows16' '{0}/upsampled' '{0}/rows64' '{0}/true/dense_map.ply' --drive "
      "'{1}'",
      folder, drive_of_64());
  const std::vector<MapRow> rows = rows_of(result.out);
  REQUIRE(rows.size() == 4);
  const MapRow& measured = rows[0];
  const MapRow& upsampled = rows[1];
  const MapRow& full = rows[2];
  CHECK(measured.accuracy_01 > 95.0);
  CHECK(measured.far < 1.0);
  CHECK(full.complete_01 > 75.0);  // 81 when this was written
  CHECK(full.f1_01 > measured.f1_01 + 0.15);
  CHECK(upsampled.complete_01 > measured.complete_01 + 5.0);
  // Interpolation from true poses: 86.4 and 9.2. Most of these scans were taken standing, where
  // a wrong guess is made again and again.
  CHECK(upsampled.accuracy_02 > 80.0);
  CHECK(upsampled.far < 12.0);
  CHECK(upsampled.f1_02 > measured.f1_02 + 0.02);
  // The same map from true poses: SLAM costs next to nothing here.
  CHECK(std::abs(rows[3].f1_01 - measured.f1_01) < 0.05);
  CHECK(holds(measured.rest, "aligned"));
  CHECK_FALSE(holds(rows[3].rest, "aligned"));
}

TEST_CASE("scans whose poses a TUM file does not have are left out of the map, and that is said") {
  const TemporaryDirectory out;
  std::istringstream truth(file_contents(simulated_drive() + "/truth.tum"));
  std::string some;
  std::string line;
  for (int i = 0; std::getline(truth, line); ++i) {
    if (i % 3 == 0) some += line + "\n";
  }
  write_file(out.file("some.tum"), some);
  const ProgramResult result = succeeds("map '{}' --poses '{}' --out '{}'", simulated_drive(),
                                        out.file("some.tum"), out.file("map"));
  CHECK(missing(result.out, {"of 4 scans", "8 scans without a pose left out"}) == "");
  const ProgramResult first = succeeds("map '{}' --poses '{}' --scans ..4 --out '{}'",
                                       simulated_drive(), out.file("some.tum"), out.file("map"));
  CHECK(missing(first.out, {"of 2 scans", "3 scans without a pose left out"}) == "");
}

TEST_CASE("poses of a survey, thousands of kilometres from its origin, make no map") {
  const TemporaryDirectory out;
  Trajectory truth = read_tum(simulated_drive() + "/truth.tum");
  for (StampedPose& pose : truth) pose.T_map_sensor.translation() += Eigen::Vector3d(5e5, 5.4e6, 0);
  write_tum(truth, out.file("utm.tum"));
  CHECK(missing(refused("map '{}' --poses '{}' --out '{}'", simulated_drive(), out.file("utm.tum"),
                        out.file("map")),
                {"within 100 km", "found one 5400 km away"}) == "");
}

/// What `map` says of a drive's true poses after a change.
std::string said_of_poses(const std::string& drive, const auto& change) {
  const TemporaryDirectory folder;
  const std::string poses = folder.file("poses.tum");
  Trajectory trajectory = read_tum(drive + "/truth.tum");
  for (StampedPose& pose : trajectory) change(pose);
  write_tum(trajectory, poses);
  return succeeds("map '{}' --poses '{}' --out '{}'", drive, poses, folder.file("out")).error;
}

TEST_CASE("poses in a camera's axes, with z downwards or of another scale are recognized") {
  const std::string drive = simulated_drive("--sensor os1-16 --scans 40");
  const Eigen::Quaterniond camera(0.5, -0.5, 0.5, -0.5);  // x right, y down, z forward
  const Eigen::Quaterniond half_roll(0.0, 1.0, 0.0, 0.0);
  const auto in_axes_of_a_camera = [&](StampedPose& pose) {
    pose.T_map_sensor = camera.inverse() * pose.T_map_sensor * camera;
  };
  const auto z_down = [&](StampedPose& pose) { pose.T_map_sensor = half_roll * pose.T_map_sensor; };
  const auto scaled = [](StampedPose& pose) { pose.T_map_sensor.translation() *= 1.1; };
  CHECK_FALSE(holds(said_of_poses(drive, [](StampedPose&) {}), "poses.tum"));
  CHECK(holds(said_of_poses(drive, in_axes_of_a_camera), "its motion differs"));
  CHECK(holds(said_of_poses(drive, z_down), "its z points down"));
  CHECK(holds(said_of_poses(drive, scaled), "its motion differs from that of the scans by 10 %"));
}

TEST_CASE("poses that do not turn with the scans are recognized: late ones, mirrored ones") {
  const TemporaryDirectory folder;
  const std::string drive = folder.file("drive");
  succeeds("simulate --drive narrow --seed 2 --sensor os1-16 --scans 80 --out '{}'", drive);
  const Eigen::Affine3d mirror(Eigen::Scaling(1.0, -1.0, 1.0));
  const auto late = [](StampedPose& pose) { pose.stamp_s += 0.3; };
  const auto mirrored = [&](StampedPose& pose) {
    pose.T_map_sensor.matrix() = (mirror * pose.T_map_sensor * mirror).matrix();
  };
  CHECK_FALSE(holds(said_of_poses(drive, [](StampedPose&) {}), "poses.tum"));
  CHECK(holds(said_of_poses(drive, late), " differ"));
  CHECK(holds(said_of_poses(drive, mirrored), "its turns differ"));
}

TEST_CASE("a map is aligned by the trajectory beside it, however the map is named") {
  const TemporaryDirectory folder;
  fs::copy(simulated_drive() + "/truth.tum", folder.file("trajectory.tum"));
  write_points({{5.0F, 0.0F, 0.0F}}, folder.file("dense_map.pcd"));
  for (const char* map : {"dense_map.pcd", "./dense_map.pcd", "."}) {
    CAPTURE(map);
    const ProgramResult result =
        run_shell(fmt::format("cd '{}'; '{}' evaluate-map {} --drive '{}'", folder.path(),
                              HQSLAM_LAB_PROGRAM, map, simulated_drive()));
    CAPTURE(result.error);
    CHECK(result.status == 0);
    CHECK(holds(result.out, fmt::format("  {} (aligned)\n", map)));
  }
}

TEST_CASE("a map that cannot be made costs that map alone") {
  const TemporaryDirectory folder;
  write_stack(folder.file("empty.npy"), std::vector(3, RangeImage(16, 1024)));
  const ProgramResult result =
      run_hqslam("run '{}' --sensor os1-16 --dense-map --occupancy-grid --out '{}'",
                 folder.file("empty.npy"), folder.file("out"));
  CHECK(holds(refusal(result), "occupancy grid: expected scans that were located"));
  CHECK(missing(result.out, {"results: ", "dense_map.ply"}) == "");
}

}  // namespace hqslam::test
