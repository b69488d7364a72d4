#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "hqslam/core/trajectory.h"
#include "tools/program/program.h"

namespace hqslam::test {
namespace {

/// A run over the simulated drive that saved its map.
std::string saved_map() {
  static const TemporaryDirectory out;
  static const ProgramResult result = run_hqslam(
      fmt::format("run '{}' --save-map --out '{}'", simulated_drive(), out.path().string()));
  CAPTURE(result.error);
  REQUIRE(result.status == 0);
  CHECK(result.out.find("saved_map.npz") != std::string::npos);
  return out.file("saved_map.npz");
}

}  // namespace

TEST_CASE("a drive is located in the map that another run saved, where it begins or anywhere") {
  for (const std::string start : {"", " --start 0.5,-0.5,5"}) {
    CAPTURE(start);
    const TemporaryDirectory out;
    const ProgramResult result =
        run_hqslam(fmt::format("run '{}' --map '{}'{} --out '{}'", simulated_drive(), saved_map(),
                               start, out.path().string()));
    CAPTURE(result.error);
    REQUIRE(result.status == 0);
    CHECK(result.out.find("located in the map of") != std::string::npos);
    const auto timings = nlohmann::json::parse(file_contents(out.file("timings.json")));
    CHECK(timings["located_in"] == saved_map());
    CHECK(timings["key_frames"] == 0);
    CHECK(timings["mapping_status"]["not recognized"].get<int>() <= 2);
    // The map's frame is that of the drive's first scan: the same path comes out.
    const Trajectory path = read_tum(out.file("trajectory.tum"));
    const Trajectory mapped =
        read_tum((std::filesystem::path(saved_map()).parent_path() / "trajectory.tum").string());
    REQUIRE(path.size() == mapped.size());
    CHECK(
        (path.back().T_map_sensor.translation() - mapped.back().T_map_sensor.translation()).norm() <
        0.03);
  }
}

TEST_CASE("what was not recognized is in no error against the reference") {
  const TemporaryDirectory folder;
  const std::string other = folder.file("elsewhere");
  run_hqslam(
      fmt::format("simulate --drive town --seed 3 --sensor os1-16 --scans 6 --out '{}'", other));
  const ProgramResult lost = run_hqslam(
      fmt::format("run '{}' --map '{}' --out '{}'", other, saved_map(), folder.file("lost")));
  CAPTURE(lost.error);
  CHECK(lost.status == 0);
  CHECK(lost.out.find("6 scans not recognized") != std::string::npos);
  CHECK(lost.out.find("APE RMSE") == std::string::npos);
  CHECK(lost.out.find("not located: no place of the map of") != std::string::npos);
  CHECK(lost.out.find("\nlocated in") == std::string::npos);
}

TEST_CASE("a map belongs to the run that saved it, and is not located in and made at once") {
  const TemporaryDirectory out;
  const std::string folder = out.path().string();
  REQUIRE(
      run_hqslam(fmt::format("run '{}' --save-map --out '{}'", simulated_drive(), folder)).status ==
      0);
  CHECK(std::filesystem::exists(out.file("saved_map.npz")));
  REQUIRE(run_hqslam(fmt::format("run '{}' --out '{}'", simulated_drive(), folder)).status == 0);
  CHECK_FALSE(std::filesystem::exists(out.file("saved_map.npz")));
  for (const std::string& other :
       {fmt::format("--map '{}'", saved_map()), std::string("--no-loop-closing")}) {
    const ProgramResult result = run_hqslam(
        fmt::format("run '{}' {} --save-map --out '{}'", simulated_drive(), other, folder));
    CHECK(result.status == 2);
    CHECK(result.error.find("--save-map") != std::string::npos);
  }
}

TEST_CASE("a map in the folder whose results would be replaced is refused, and stays") {
  const TemporaryDirectory folder;
  const std::string map = folder.file("saved_map.npz");
  std::filesystem::copy(saved_map(), map);
  std::filesystem::create_directory_symlink(folder.path(), folder.file("link"));
  write_file(folder.file("timings.json"), "{\n  \"written_by\": \"hqslam run\",\n}");
  for (const std::string& out : {folder.path().string(), folder.file("link")}) {
    const ProgramResult result =
        run_hqslam(fmt::format("run '{}' --map '{}' --out '{}'", simulated_drive(), map, out));
    CHECK(result.status == 2);
    CHECK(is_one_line(result.error));
    CHECK(holds(result.error, map + ": is read by this command and would be replaced"));
  }
  CHECK(file_contents(map) == file_contents(saved_map()));
}

TEST_CASE("a file that is no saved map is refused before anything is written") {
  const TemporaryDirectory folder;
  const std::string trajectory = simulated_drive() + "/truth.tum";
  const ProgramResult result = run_hqslam(fmt::format(
      "run '{}' --map '{}' --out '{}'", simulated_drive(), trajectory, folder.file("out")));
  CHECK(result.status == 2);
  CHECK(result.error.find(trajectory) != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder.file("out")));
}

}  // namespace hqslam::test
