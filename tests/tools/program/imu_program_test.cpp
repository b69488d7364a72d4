#include "hqslam/core/imu_sample.h"
#include "tools/program/program.h"

namespace hqslam::test {
TEST_CASE("a simulated drive's inertial data are used, or another file of them that is given") {
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
  CHECK(holds(summary, "inertial sensor: predicted 35 of 40 scans\n"));  // the first ones prove it
  const std::string without = run("", "without");
  CHECK(!holds(summary, "inertial sensor"));
  const std::string given = run("--imu '" + folder.file("moved.csv") + "'", "given");
  CHECK(file_contents(by_default + "/trajectory.tum") == file_contents(given + "/trajectory.tum"));
  CHECK(end_error_m(given, drive) < 0.5 * end_error_m(without, drive));

  // Ten a second are too few, and are not used, which is said.
  std::istringstream all(file_contents(folder.file("moved.csv")));
  std::string few;
  int number = 0;
  for (std::string line; std::getline(all, line); ++number) {
    if (number % 10 == 0) few += line + "\n";
  }
  write_file(folder.file("few.csv"), few);
  const std::string unused = run("--imu '" + folder.file("few.csv") + "'", "few");
  CHECK(holds(summary,
              "inertial sensor: predicted 0 of 40 scans; it has 10.3 samples a second, SLAM"));
  CHECK(file_contents(unused + "/trajectory.tum") == file_contents(without + "/trajectory.tum"));

  // Forces in g are not used either, which info and run say.
  std::string in_g;
  for (const ImuSample& sample : read_imu_csv(folder.file("moved.csv"))) {
    const Eigen::Vector3d& turn = sample.angular_rate_rad_per_s;
    const Eigen::Vector3d force = sample.specific_force_mps2 / kGravity_mps2;
    in_g += fmt::format("{},{},{},{},{},{},{}\n", sample.stamp_s, turn.x(), turn.y(), turn.z(),
                        force.x(), force.y(), force.z());
  }
  write_file(drive + "/imu.csv", in_g);
  CHECK(holds(succeeds("info '{}'", drive).out, "not gravity's 9.81; in g?"));
  run("", "in_g");
  CHECK(holds(summary, "predicted 0 of 40 scans; not used otherwise: its forces of"));
  CHECK(holds(summary, "not gravity's 9.81; in g?"));
}

}  // namespace hqslam::test
