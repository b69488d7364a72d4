#include <doctest/doctest.h>

#include <filesystem>

#include "file_contents.h"
#include "hqslam/core/trajectory.h"
#include "tools/program/program.h"

namespace hqslam::test {
namespace {

namespace fs = std::filesystem;

/// Of the position in the last scan.
double error_m(const std::string& results, const std::string& drive) {
  const Trajectory found = read_tum(results + "/trajectory.tum");
  const Trajectory truth = read_tum(drive + "/truth.tum");
  REQUIRE(found.size() == truth.size());
  return (found.back().T_map_sensor.translation() - truth.back().T_map_sensor.translation()).norm();
}

}  // namespace

TEST_CASE(
    "a simulated drive's inertial data are used, and another file of them where one is given") {
  const TemporaryDirectory folder;
  const std::string drive = folder.file("drive");
  succeeds("simulate --drive handheld-turning --sensor os1-16 --scans 40 --seed 3 --imu --out '{}'",
           drive);
  const auto run = [&](const std::string& options, const std::string& name) {
    succeeds("run '{}' {} --out '{}'", drive, options, folder.file(name));
    return folder.file(name);
  };
  const std::string by_default = run("", "default");
  fs::rename(drive + "/imu.csv", folder.file("moved.csv"));
  const std::string without = run("", "without");
  const std::string given = run("--imu '" + folder.file("moved.csv") + "'", "given");
  CHECK(file_contents(by_default + "/trajectory.tum") == file_contents(given + "/trajectory.tum"));
  CHECK(error_m(given, drive) < 0.5 * error_m(without, drive));

  write_file(folder.file("bad.csv"), "1,2,3\n");
  const ProgramResult result = refused("run '{}' --imu '{}' --out '{}'", drive,
                                       folder.file("bad.csv"), folder.file("refused"));
  CHECK(holds(result.error, "bad.csv:1: expected 7 numbers"));
}

}  // namespace hqslam::test
