#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "hqslam/core/trajectory.h"
#include "tools/program/program.h"

namespace hqslam::test {
namespace {

/// A run over the simulated drive that saved its map.
std::string saved_map() {
  static const TemporaryDirectory out;
  static const ProgramResult result =
      succeeds("run '{}' --save-map --out '{}'", simulated_drive(), out.path().string());
  CHECK(holds(result.out, "saved_map.npz"));
  return out.file("saved_map.npz");
}

}  // namespace

TEST_CASE("a drive is located in the map that another run saved, where it begins or anywhere") {
  for (const std::string start : {"", " --start 0.5,-0.5,5"}) {
    CAPTURE(start);
    const TemporaryDirectory out;
    const ProgramResult result = succeeds("run '{}' --map '{}'{} --out '{}'", simulated_drive(),
                                          saved_map(), start, out.path().string());
    CHECK(holds(result.out, "located in the map of"));
    const auto timings = json_of(out.file("timings.json"));
    CHECK(timings["located_in"] == saved_map());
    CHECK(timings["key_frames"] == 0);
    CHECK(timings["mapping_status"]["not recognized"].get<int>() <= 2);
    // The map's frame is that of the drive's first scan: the same path comes out.
    const Trajectory path = read_tum(out.file("trajectory.tum"));
    const Trajectory mapped =
        read_tum((fs::path(saved_map()).parent_path() / "trajectory.tum").string());
    REQUIRE(path.size() == mapped.size());
    CHECK(
        (path.back().T_map_sensor.translation() - mapped.back().T_map_sensor.translation()).norm() <
        0.03);
  }
}

TEST_CASE("what was not recognized is in no error against the reference") {
  const TemporaryDirectory folder;
  const std::string other = folder.file("elsewhere");
  run_hqslam("simulate --drive town --seed 3 --sensor os1-16 --scans 6 --out '{}'", other);
  const ProgramResult lost = run_hqslam("run '{}' --map '{}' --occupancy-grid --out '{}'", other,
                                        saved_map(), folder.file("lost"));
  CHECK(lost.status == 2);
  CHECK(holds(last_line(lost.error),
              "occupancy grid: expected scans that were located, found none "
              "of 6"));
  CHECK(holds(lost.error, "of a located scan, of"));
  CHECK(holds(lost.out, "6 scans not recognized"));
  CHECK_FALSE(holds(lost.out, "APE RMSE"));
  CHECK(holds(lost.out, "not located: no place of the map of"));
  CHECK_FALSE(holds(lost.out, "\nlocated in"));
}

TEST_CASE("a map belongs to the run that saved it, and is not located in and made at once") {
  const TemporaryDirectory out;
  const std::string folder = out.path().string();
  succeeds("run '{}' --save-map --out '{}'", simulated_drive(), folder);
  CHECK(fs::exists(out.file("saved_map.npz")));
  succeeds("run '{}' --out '{}'", simulated_drive(), folder);
  CHECK_FALSE(fs::exists(out.file("saved_map.npz")));
  for (const std::string& other :
       {fmt::format("--map '{}'", saved_map()), std::string("--no-loop-closing")}) {
    CHECK(
        holds(refused("run '{}' {} --save-map --out '{}'", simulated_drive(), other, folder).error,
              "--save-map"));
  }
}

TEST_CASE("a map in the folder whose results would be replaced is refused, and stays") {
  const TemporaryDirectory folder;
  const std::string map = folder.file("saved_map.npz");
  fs::copy(saved_map(), map);
  fs::create_directory_symlink(folder.path(), folder.file("link"));
  write_file(folder.file("timings.json"), "{\n  \"written_by\": \"hqslam run\",\n}");
  for (const std::string& out : {folder.path().string(), folder.file("link")}) {
    CHECK(holds(refused("run '{}' --map '{}' --out '{}'", simulated_drive(), map, out).error,
                map + ": is read by this command and would be replaced"));
  }
  CHECK(file_contents(map) == file_contents(saved_map()));
}

TEST_CASE("a drive is located in a cloud of the place, as its dense map is one") {
  const TemporaryDirectory folder;
  const std::string& drive = simulated_drive("--sensor os1-16 --scans 40");
  succeeds("run '{}' --dense-map --out '{}'", drive, folder.file("dense"));
  for (const std::string ending : {".pcd", ".ply"}) {
    CAPTURE(ending);
    const std::string map = folder.file("dense/dense_map") + ending;
    CHECK(holds(succeeds("run '{}' --map '{}' --out '{}'", drive, map, folder.file("located")).out,
                "located in the map of " + map));
    const Trajectory path = read_tum(folder.file("located/trajectory.tum"));
    const Trajectory truth = read_tum(drive + "/truth.tum");
    CHECK(
        (path.back().T_map_sensor.translation() - truth.back().T_map_sensor.translation()).norm() <
        0.1);
  }
  write_file(folder.file("few.txt"), "0 0 0\n1 0 0\n0 1 0\n");
  const ProgramResult few =
      refused("run '{}' --map '{}' --out '{}'", drive, folder.file("few.txt"), folder.file("none"));
  CHECK(holds(few.error, folder.file("few.txt") + ": expected a cloud with at least"));
  CHECK_FALSE(fs::exists(folder.file("none")));
}

TEST_CASE("a map is not extended by a drive elsewhere, nor over itself, and stays as it was") {
  const TemporaryDirectory folder;
  const std::string map = folder.file("mapped/saved_map.npz");
  fs::create_directory(folder.file("mapped"));
  fs::copy(saved_map(), map);
  write_file(folder.file("mapped/timings.json"), "{\n  \"written_by\": \"hqslam run\",\n}");
  const ProgramResult over = refused("run '{}' --map '{}' --extend --out '{}'", simulated_drive(),
                                     map, folder.file("mapped"));
  CHECK(holds(over.error, map + ": is read by this command and would be replaced"));
  const std::string other = folder.file("elsewhere");
  run_hqslam("simulate --drive town --seed 3 --sensor os1-16 --scans 6 --out '{}'", other);
  const ProgramResult elsewhere =
      run_hqslam("run '{}' --map '{}' --extend --out '{}'", other, map, folder.file("out"));
  CHECK(elsewhere.status == 2);
  CHECK(holds(elsewhere.error, "not extended"));
  CHECK(fs::exists(folder.file("out/trajectory.tum")));
  CHECK_FALSE(fs::exists(folder.file("out/saved_map.npz")));
  CHECK(file_contents(map) == file_contents(saved_map()));
}

}  // namespace hqslam::test
