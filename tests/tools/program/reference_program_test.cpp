#include "tools/program/program.h"

namespace hqslam::test {
TEST_CASE("behind a bad file, which is named, scans keep their stamps and reference poses") {
  const TemporaryDirectory folder;
  fs::copy(simulated_drive() + "/bin", folder.file("bin"));
  fs::resize_file(folder.file("bin/000005.bin"), 1001);
  const std::string truth = simulated_drive() + "/truth.kitti";
  const ProgramResult run =
      succeeds("run '{0}/bin' --sensor os1-16 --no-loop-closing --reference '{1}' --out '{0}/out'",
               folder.path(), truth);
  CHECK(holds(last_line(run.error), "000005.bin"));
  const nlohmann::json timings = json_of(folder.file("out/timings.json"));
  CHECK(timings["scans_left_out"] == 1);
  CHECK(holds(timings["left_out"][0].get<std::string>(), "000005.bin"));
  const Trajectory trajectory = read_tum(folder.file("out/trajectory.tum"));
  REQUIRE(trajectory.size() == kDriveScans - 1);
  CHECK(trajectory[5].stamp_s == doctest::Approx(0.6));  // as if none were missing
  const std::size_t rmse = run.out.find("APE RMSE ");
  REQUIRE(rmse != std::string::npos);
  CHECK(std::stod(run.out.substr(rmse + 9)) < 0.1);  // 0.3 if scan 6 had the pose of scan 5
  const ProgramResult map =
      succeeds("map '{0}/bin' --sensor os1-16 --poses '{1}' --out '{0}/map'", folder.path(), truth);
  CHECK(holds(map.out, fmt::format("of {} scans", kDriveScans - 1)));
  CHECK(holds(map.error, "1 scan was left out"));
  // A scan's number is that in the recording.
  const std::string bin = fmt::format("'{}' --sensor os1-16", folder.file("bin"));
  for (const char* command : {"inspect --slam", "view"}) {
    CAPTURE(command);
    const std::string page = folder.file(std::string(command, 4) + ".html");
    succeeds("{} {} --scan {} --out '{}'", command, bin, kDriveScans - 1, page);
    CHECK(holds(refusal(run_hqslam("{} {} --scan 5 --out '{}'", command, bin, page)),
                command[0] == 'i' ? "000005.bin" : "expected a scan 5"));
  }
}

TEST_CASE("a reference by the clock of the scans' own stamps is compared with them") {
  const TemporaryDirectory folder;
  fs::create_directory(folder.file("velodyne_points"));
  fs::copy(simulated_drive() + "/bin", folder.file("velodyne_points/data"));
  constexpr double kClock_s = 1317042145.5;
  Trajectory truth = read_tum(simulated_drive() + "/truth.tum");
  std::string stamps;
  for (StampedPose& pose : truth) {
    pose.stamp_s += kClock_s;
    stamps += fmt::format("{:.3f}\n", pose.stamp_s);
  }
  write_file(folder.file("velodyne_points/timestamps.txt"), stamps);
  write_tum(truth, folder.file("truth.tum"));
  const ProgramResult result = succeeds(
      "run '{0}/velodyne_points/data' --sensor os1-16 --reference '{0}/truth.tum' --out '{0}/out'",
      folder.path());
  CHECK(holds(result.out, fmt::format("over {} poses", kDriveScans)));
}

TEST_CASE("a reference with other stamps than the scans' is named with both") {
  const TemporaryDirectory folder;
  const std::string drive = simulated_drive();  // whose truth is that of the middle of each scan
  const auto run = [&](const std::string& capture) {
    return succeeds("run '{0}/bin' --sensor os1-16 {1} --reference '{0}/truth.tum' --out '{2}'",
                    drive, capture, folder.file("out"));
  };
  CHECK(holds(
      run("--capture corrected").error,
      fmt::format("truth.tum: fewer than 3 of its poses, of 0.050 to {:.3f} s, are within "
                  "0.02 s of a located scan, of 0.000 to {:.3f} s: not compared with it; give the "
                  "stamps of trajectory.tum",
                  kDriveScans * 0.1 - 0.05, kDriveScans * 0.1 - 0.1)));
  CHECK(holds(run("--capture rolling").out, fmt::format("over {} poses", kDriveScans)));
}

}  // namespace hqslam::test
