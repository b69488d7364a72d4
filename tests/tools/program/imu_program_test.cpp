#include <doctest/doctest.h>

#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>

#include "file_contents.h"
#include "hqslam/core/trajectory.h"
#include "tools/program/program.h"

namespace hqslam::test {
namespace {

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
  CHECK(holds(succeeds("info '{}'", drive).out, "inertial    imu.csv, "));
  std::string summary;
  const auto run = [&](const std::string& options, const std::string& name) {
    summary = succeeds("run '{}' {} --out '{}'", drive, options, folder.file(name)).out;
    return folder.file(name);
  };
  const std::string by_default = run("", "default");
  fs::rename(drive + "/imu.csv", folder.file("moved.csv"));
  CHECK_FALSE(holds(succeeds("info '{}'", drive).out, "inertial"));
  CHECK(holds(summary, "inertial sensor: predicted 39 of 40 scans\n"));
  const std::string without = run("", "without");
  CHECK(!holds(summary, "inertial sensor"));
  const std::string given = run("--imu '" + folder.file("moved.csv") + "'", "given");
  CHECK(file_contents(by_default + "/trajectory.tum") == file_contents(given + "/trajectory.tum"));
  CHECK(error_m(given, drive) < 0.5 * error_m(without, drive));

  // Ten a second are too few, and are not used, which is said.
  std::istringstream all(file_contents(folder.file("moved.csv")));
  std::string few;
  int number = 0;
  for (std::string line; std::getline(all, line); ++number) {
    if (number % 10 == 0) few += line + "\n";
  }
  write_file(folder.file("few.csv"), few);
  const std::string unused = run("--imu '" + folder.file("few.csv") + "'", "few");
  CHECK(holds(summary, "inertial sensor: predicted 0 of 40 scans; for others its samples"));
  CHECK(file_contents(unused + "/trajectory.tum") == file_contents(without + "/trajectory.tum"));

  // Nor are those of another clock.
  write_file(folder.file("late.csv"), "1000,0,0,0,0,0,9.8\n1000.01,0,0,0,0,0,9.8\n");
  const ProgramResult late = succeeds("run '{}' --imu '{}' --out '{}'", drive,
                                      folder.file("late.csv"), folder.file("late"));
  CHECK(holds(late.error,
              "late.csv: has samples of 1000.000 to 1000.010 s, the scans are of 0.050 "
              "to 3.950 s: 0 of 40 scans have some; stamp them"));

  write_file(folder.file("bad.csv"), "1,2,3\n");
  const ProgramResult result = refused("run '{}' --imu '{}' --out '{}'", drive,
                                       folder.file("bad.csv"), folder.file("refused"));
  CHECK(holds(result.error, "bad.csv:1: expected 7 numbers"));
}

TEST_CASE("inertial data that disagree with the scans are left out with a reason") {
  const TemporaryDirectory folder;
  const std::string drive = folder.file("drive");
  succeeds("simulate --drive handheld --sensor os1-16 --scans 60 --seed 4 --imu --out '{}'", drive);
  const auto run = [&](const std::string& imu) {
    const std::string out =
        succeeds("run '{}' --imu '{}' --no-loop-closing --out '{}'", drive, imu, folder.file("out"))
            .out;
    return std::pair(out, error_m(folder.file("out"), drive));
  };
  const auto [alone, alone_m] = run("none");
  CHECK_FALSE(holds(alone, "inertial"));
  const auto written = [&](const std::string& name, const auto& changed) {
    std::istringstream all(file_contents(drive + "/imu.csv"));
    std::string text;
    std::getline(all, text);  // the names of the columns
    text.clear();
    double v[7];
    for (std::string line; std::getline(all, line);) {
      REQUIRE(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf", v, v + 1, v + 2, v + 3,
                          v + 4, v + 5, v + 6) == 7);
      changed(v);
      text += fmt::format("{},{},{},{},{},{},{}\n", v[0], v[1], v[2], v[3], v[4], v[5], v[6]);
    }
    write_file(folder.file(name), text);
    return folder.file(name);
  };
  const auto [stuck, stuck_m] = run(written("stuck.csv", [](double* v) {
    for (int i = 1; i < 7; ++i) v[i] = i == 6 ? 9.80665 : 0.0;
  }));
  CHECK(holds(stuck, "left out: it"));
  CHECK(stuck_m < alone_m + 0.05);
  const auto [degrees, degrees_m] = run(written("degrees.csv", [](double* v) {
    for (int i = 1; i < 4; ++i) v[i] *= 57.29578;
  }));
  CHECK(holds(degrees, "degrees per second?"));
  CHECK(degrees_m < alone_m + 0.05);
  const auto [downwards, downwards_m] = run(written("downwards.csv", [](double* v) {
    for (int i = 4; i < 7; ++i) v[i] *= -1.0;
  }));
  CHECK(holds(downwards, "point downwards"));
  CHECK(downwards_m < alone_m + 0.05);
}

}  // namespace hqslam::test
