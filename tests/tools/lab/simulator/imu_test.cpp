#include "hqslam/sim/imu.h"

#include "hqslam/sim/write_drive.h"
#include "sample_statistics.h"
#include "scenario.h"
#include "small_city.h"

using namespace hqslam::sim;

TEST_CASE("integrating what a perfect inertial sensor measures leads along the true path") {
  for (const char* drive : {"town", "handheld-turning", "indoors"}) {
    CAPTURE(drive);
    const Motion motion = make_scenario(drive_preset(drive), 20.0).T_world_sensor;
    constexpr double kHalf_s = 0.5 * kImuPeriod_s;
    constexpr int kFirst = 300;
    const double begin_s = kFirst * kImuPeriod_s - kHalf_s;
    Pose pose = motion(begin_s);
    Eigen::Vector3d velocity_mps =
        (motion(begin_s + 1e-3).translation() - motion(begin_s - 1e-3).translation()) / 2e-3;
    for (int k = kFirst; k < kFirst + 1000; ++k) {
      const SimulatedImuSample sample = exact_imu_sample(motion, k * kImuPeriod_s);
      const Twist half_turn{Eigen::Vector3d::Zero(), kHalf_s * sample.angular_rate_rad_per_s};
      const Eigen::Matrix3d turn = exponential(half_turn).linear();
      const Eigen::Vector3d before_mps = velocity_mps;
      velocity_mps += kImuPeriod_s * (pose.linear() * turn * sample.specific_force_mps2 -
                                      kGravity_mps2 * Eigen::Vector3d::UnitZ());
      pose.translation() += kHalf_s * (before_mps + velocity_mps);
      pose.linear() = pose.linear() * turn * turn;
    }
    const Pose off = motion(begin_s + 10.0).inverse() * pose;
    CHECK(off.translation().norm() < 0.003);
    CHECK(rotation_angle_rad(off) < 1e-6);
  }
}

TEST_CASE("noise has the data sheet's size, biases walk, and a standing sensor feels its weight") {
  const Motion still = [](double /*time_s*/) { return Pose::Identity(); };
  SimulatedImu imu(3);
  std::vector<double> rates, forces;
  for (int k = 0; k < 20'000; ++k) {
    const double stamp_s = imu.next_stamp_s();
    const SimulatedImuSample sample = imu.next(still);
    REQUIRE(sample.stamp_s == stamp_s);
    const Eigen::Vector3d force = sample.specific_force_mps2 - sample.accelerometer_bias_mps2;
    rates.push_back((sample.angular_rate_rad_per_s - sample.gyroscope_bias_rad_per_s).x());
    forces.push_back(force.z() - kGravity_mps2);
  }
  CHECK(deviation_of(rates) == doctest::Approx(0.15 * std::numbers::pi / 180.0).epsilon(0.02));
  CHECK(deviation_of(forces) == doctest::Approx(0.0226).epsilon(0.02));
  std::vector<double> walked;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SimulatedImu other(seed);
    const Eigen::Vector3d first = other.next(still).accelerometer_bias_mps2;
    for (int k = 0; k < 99; ++k) other.next(still);
    walked.push_back((other.next(still).accelerometer_bias_mps2 - first).x());
  }
  CHECK(deviation_of(walked) == doctest::Approx(3.0e-3).epsilon(0.1));  // after a second
}

TEST_CASE("a drive's inertial samples are written beside it if asked for, skipped scans' too") {
  const TemporaryDirectory folder;
  const DriveSpec spec{"block", 1, 4, {}, {}};
  const auto written = [&](bool imu, const std::string& name) {
    DriveSimulator simulator(spec, small_sensor());
    DriveWriter writer(folder.file(name), spec, small_sensor(), {.imu = imu});
    simulator.skip(1);
    while (const auto scan = simulator.next()) writer.append(*scan);
    return folder.file(name);
  };
  const std::string samples = file_contents(written(true, "with") + "/imu.csv");
  CHECK(std::ranges::count(samples, '\n') == 41);
  CHECK(samples.rfind("stamp_s,angular_rate_x_rad_per_s", 0) == 0);
  CHECK_FALSE(std::filesystem::exists(written(false, "without") + "/imu.csv"));
}
