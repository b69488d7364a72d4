#include "tools/program/program.h"

namespace hqslam::test {
namespace {

/// A run over the simulated drive that saved its map.
std::string saved_map() {
  static const TemporaryDirectory out;
  static const ProgramResult result =
      succeeds("run '{}' --save-map --out '{}'", simulated_drive(), out.path());
  CHECK(holds(result.out, "saved_map.npz"));
  return out.file("saved_map.npz");
}

}  // namespace

TEST_CASE("a drive is located in the map that another run saved, where it begins or anywhere") {
  for (const std::string start : {"", " --start 0.5,-0.5,5"}) {
    CAPTURE(start);
    const TemporaryDirectory out;
    const ProgramResult result = succeeds("run '{}' --map '{}'{} --out '{}'", simulated_drive(),
                                          saved_map(), start, out.path());
    CHECK(holds(result.out, "located in the map of"));
    const auto timings = json_of(out.file("timings.json"));
    CHECK(timings["located_in"] == saved_map());
    CHECK(timings["keyframes"] == 0);
    CHECK(timings["mapping_status"]["not recognized"].get<int>() <= 2);
    // The map's frame is that of the drive's first scan: the same path comes out.
    const Trajectory path = read_tum(out.file("trajectory.tum"));
    const Trajectory map = read_tum(fs::path(saved_map()).parent_path() / "trajectory.tum");
    REQUIRE(path.size() == map.size());
    CHECK((path.back().T_map_sensor.translation() - map.back().T_map_sensor.translation()).norm() <
          0.03);
  }
}

TEST_CASE("what was not recognized is in no error against the reference") {
  const TemporaryDirectory folder;
  const std::string other = folder.file("elsewhere");
  run_hqslam("simulate --drive town --seed 3 --sensor os1-16 --scans 6 --out '{}'", other);
  const ProgramResult lost = run_hqslam("run '{}' --map '{}' --occupancy-grid --out '{}'", other,
                                        saved_map(), folder.file("lost"));
  CHECK(holds(refusal(lost), "grid: expected scans that were located, found none of 6"));
  CHECK(holds(lost.error, "of a located scan, of"));
  CHECK(holds(lost.out, "6 scans not recognized"));
  CHECK_FALSE(holds(lost.out, "APE RMSE"));
  CHECK(holds(lost.out, "not located: no place of the map of"));
  CHECK_FALSE(holds(lost.out, "\nlocated in"));
  CHECK(holds(refusal(run_hqslam("run '{}' --map '{}' --out '{}'", other, saved_map(),
                                 folder.file("lost"))),
              "no scan was located in " + saved_map()));
}

TEST_CASE("a drive is not located in a map and mapped at once, nor saved without loop closing") {
  const TemporaryDirectory out;
  for (const std::string& other :
       {fmt::format("--map '{}'", saved_map()), std::string("--no-loop-closing")}) {
    CHECK(holds(refused("run '{}' {} --save-map --out '{}'", simulated_drive(), other, out.path()),
                "--save-map"));
  }
}

}  // namespace hqslam::test
