#include "hqslam/slam/occupancy_grid.h"
#include "tools/program/program.h"

namespace hqslam::test {
TEST_CASE("where the sensor drove, the occupancy grid of a run is free") {
  const TemporaryDirectory out;
  const ProgramResult run =
      succeeds("run '{}' --rows 16 --occupancy-grid --out '{}'", drive_of_64(), out.path());
  CHECK(holds(run.out, "occupancy grid: "));
  CHECK(holds(last_line(run.out), "report.html, map.pgm, map.yaml"));
  CHECK(holds(file_contents(out.file("map.yaml")), "image: map.pgm\nmode: trinary\n"));
  const slam::OccupancyMap map = slam::read_occupancy_map(out.file("map.yaml"));
  std::map<slam::Occupancy, int> cells;
  for (const StampedPose& pose : read_tum(out.file("trajectory.tum"))) {
    ++cells[map.at(pose.T_map_sensor.translation().head<2>())];
  }
  CHECK(cells[slam::Occupancy::kFree] > 10);
  CHECK(cells[slam::Occupancy::kOccupied] == 0);
}

TEST_CASE("a run gives the same bytes with one thread and with two") {
  std::vector<std::string> results;
  const TemporaryDirectory out;
  for (const int threads : {1, 2}) {
    succeeds("run '{}' --occupancy-grid --grid-cell 0.2 --threads {} --out '{}'", simulated_drive(),
             threads, out.path());
    results.emplace_back();
    for (const char* name : {"map.pgm", "map.yaml", "trajectory.tum", "map.pcd"}) {
      results.back() += file_contents(out.file(name));
    }
  }
  CHECK(results[0].size() > 1000);
  CHECK(results[0] == results[1]);
}

}  // namespace hqslam::test
