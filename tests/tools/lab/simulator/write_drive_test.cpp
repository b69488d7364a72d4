#include "hqslam/sim/write_drive.h"

#include "hqslam/core/cloud_file.h"
#include "hqslam/core/kitti_bin.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/recordings/recording.h"
#include "small_city.h"

using namespace hqslam::sim;

TEST_CASE("a drive that is written part of the way reads back as what was simulated") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("drive");
  const DriveSpec spec{"block", 1, 5, {}, {}};
  DriveSimulator simulator(spec, small_sensor());
  DriveWriter writer(out, spec, simulator.sensor(), {.kitti_bin = true, .pcd = true});
  std::vector<SimulatedScan> scans;
  for (int k = 0; k < 3; ++k) {
    scans.push_back(*simulator.next());
    writer.append(scans.back());
  }

  // The writer is still open, as if the run had been cut off here.
  NpyStackReader stack(out + "/scans.npy");
  auto recording = recordings::Recording::open(out);
  const Trajectory tum = read_tum(out + "/truth.tum");
  const Trajectory kitti = read_kitti_poses(out + "/truth.kitti");
  REQUIRE(stack.images() == 3);
  REQUIRE(tum.size() == 3);
  REQUIRE(kitti.size() == 3);
  CHECK(read_sensor_json(out + "/sensor.json").columns == 128);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(stack.read(static_cast<std::int64_t>(k)).range_m == scans[k].image.range_m);
    CHECK(tum[k].stamp_s == doctest::Approx(scans[k].stamp_s));
    CHECK(tum[k].T_map_sensor.isApprox(scans[k].T_map_sensor, 1e-8));
    CHECK(kitti[k].T_map_sensor.isApprox(scans[k].T_map_sensor, 1e-8));
    const auto returns =
        std::ranges::count_if(scans[k].image.range_m, [](float r) { return r > 0; });
    const std::string number = "00000" + std::to_string(k);
    const Scan bin = read_kitti_bin(out + "/bin/" + number + ".bin");
    const Scan pcd = read_cloud(out + "/pcd/" + number + ".pcd");
    CHECK(bin.points_m.size() == static_cast<std::size_t>(returns));
    CHECK(pcd.points_m.size() == static_cast<std::size_t>(returns));
    const OrganizedCloud cloud = recording.next()->cloud;
    CHECK(std::ranges::equal(cloud.intensity, scans[k].intensity));
    CHECK(std::ranges::count_if(cloud.intensity, [](float value) { return value > 0; }) == returns);
    CHECK(returns_of(cloud).intensity == bin.intensity);
    CHECK(bin.intensity == pcd.intensity);
  }
  std::ifstream columns(out + "/truth_columns.npy", std::ios::binary);
  const NpyHeader header = read_npy_header(columns, out + "/truth_columns.npy");
  CHECK(header.dtype == "<f8");
  CHECK(header.shape == std::vector<std::int64_t>{3, 128, 7});
  columns.seekg(header.data_offset_bytes + (128 + 5) * 7 * 8);
  double x_m = 0.0;
  columns.read(reinterpret_cast<char*>(&x_m), sizeof(x_m));
  CHECK(std::abs(x_m - scans[1].T_map_sensor_at_column[5].translation().x()) < 1e-12);
}

TEST_CASE("old files among the new are one clear line") {
  const TemporaryDirectory directory;
  const std::string out = directory.file("drive");
  std::filesystem::create_directories(out + "/bin");
  write_file(out + "/bin/000007.bin", "old");
  const auto write = [&] {
    DriveWriter(out, drive_preset("block"), small_sensor(), {.kitti_bin = true});
  };
  CHECK(refused_with(write, "bin", "empty"));
}
