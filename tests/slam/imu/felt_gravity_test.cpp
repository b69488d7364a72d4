#include "imu/felt_gravity.h"

#include "slam/imu/accelerometer.h"
#include "slam/steady_drive.h"

using namespace hqslam::slam;

namespace {

constexpr double kScan_s = 0.1;
constexpr double kStep_s = 0.01;

const SteadyDrive kStraight{Pose::Identity(), {10, 0, 0}, {0, 0, 1e-6}};
const SteadyDrive kRound{Pose::Identity(), {10, 0, 0}, {0.1, 0.05, 0.4}};

Trajectory poses_of(const SteadyDrive& drive) {
  Trajectory poses;
  for (int scan = 0; scan <= 30; ++scan) {
    poses.push_back({kScan_s * scan, drive.at(kScan_s * scan)});
  }
  return poses;
}

/// Three seconds of standing, by a gyroscope with this bias.
slam::ImuBuffer standing(const Eigen::Vector3d& bias_rad_per_s) {
  std::vector<ImuSample> samples;
  for (int k = 0; k <= 310; ++k) samples.push_back({kStep_s * k, bias_rad_per_s, -kGravity});
  slam::ImuBuffer imu;
  imu.add(samples);
  return imu;
}

/// Three seconds of a drive, as an inertial sensor with these errors measures them.
std::vector<ImuStep> measured(const SteadyDrive& drive, const Eigen::Vector3d& bias_mps2,
                              const ImuErrors& errors) {
  const Eigen::Vector3d& turn = drive.turn_rad_per_s;
  const Eigen::Vector3d at_lever_mps2 =
      turn.cross(drive.velocity_mps + turn.cross(Eigen::Vector3d(errors.segment<3>(4))));
  const Eigen::Matrix3d R_imu_lidar =
      exponential(Twist{Eigen::Vector3d::Zero(), errors.head<3>()}).linear();
  std::vector<ImuStep> steps;
  for (int k = 0; k < 300; ++k) {
    const Eigen::Matrix3d R = drive.at((k + 0.5) * kStep_s - errors[7]).linear();
    const Eigen::Vector3d force = at_lever_mps2 - R.transpose() * kGravity;
    steps.push_back(
        {kStep_s, R_imu_lidar * turn, (1.0 + errors[3]) * (R_imu_lidar * force) + bias_mps2});
  }
  return steps;
}

}  // namespace

TEST_CASE("gravity is measured without the acceleration of the sensor") {
  for (const SteadyDrive& drive : {kStraight, kRound}) {
    const auto felt = slam::felt_gravity(
        poses_of(drive), measured(drive, Eigen::Vector3d::Zero(), ImuErrors::Zero()));
    REQUIRE(felt);
    CHECK(felt->stamp_s == 3.0);
    CHECK((felt->gravity_mps2 - drive.at(3.0).linear().transpose() * kGravity).norm() < 5e-3);
  }
}

TEST_CASE("the effects of a bias and of each inertial error are predicted") {
  const ImuErrors large = (ImuErrors() << 0.01, 0.01, 0.01, 0.01, 0.3, 0.3, 0.3, 0.01).finished();
  const auto check = [](const Eigen::Vector3d& bias_mps2, const ImuErrors& errors) {
    const auto felt = slam::felt_gravity(poses_of(kRound), measured(kRound, bias_mps2, errors));
    REQUIRE(felt);
    const Eigen::Vector3d put_right =
        felt->gravity_mps2 + felt->of_bias * bias_mps2 + felt->of_errors * errors;
    const Eigen::Vector3d truth = kRound.at(3.0).linear().transpose() * kGravity;
    CHECK((put_right - truth).norm() < 5e-3);
    // Left alone it would be felt.
    CHECK((felt->gravity_mps2 - truth).norm() > 0.01);
  };
  check(kBias_mps2, ImuErrors::Zero());
  for (int i = 0; i < large.size(); ++i) check({0, 0, 0}, large[i] * ImuErrors::Unit(i));
}

TEST_CASE("poses that contradict the forces give no gravity") {
  Trajectory poses = poses_of(kStraight);
  const auto steps = measured(kStraight, Eigen::Vector3d::Zero(), ImuErrors::Zero());
  CHECK(slam::felt_gravity(poses, steps));
  CHECK_FALSE(slam::felt_gravity({poses.begin(), poses.begin() + 3}, steps));
  CHECK_FALSE(slam::felt_gravity(poses, {}));
  poses[17].T_map_sensor.translation().y() += 0.5;
  CHECK_FALSE(slam::felt_gravity(poses, steps));
}

TEST_CASE("gravity is taken from three whole seconds, each once, wherever the map is moved") {
  const slam::ImuBuffer imu = standing(Eigen::Vector3d::Zero());
  const auto taken = [&](slam::GravityWindow& window, std::size_t scan) {
    window.end(scan, imu, Eigen::Matrix3d::Identity());
    return window.take();
  };
  slam::GravityWindow window;
  slam::GravityWindow moved;
  slam::GravityWindow interrupted;
  const Pose move = pose_from_xyz_rpy({5, 0, 1}, 0.1, 0.2, 0.3);
  for (int scan = 0; scan <= 30; ++scan) {
    for (auto* each : {&window, &moved, &interrupted}) {
      each->add({kScan_s * scan, Pose::Identity()}, Eigen::Vector3d::Zero());
    }
    if (scan == 20) {
      CHECK(taken(window, 20).empty());
      moved.correct(move);
      interrupted.interrupt();
    }
  }
  const std::vector<slam::FeltGravity> felt = taken(window, 30);
  REQUIRE(felt.size() == 1);
  CHECK(felt[0].scan == 30);
  CHECK((felt[0].gravity_mps2 - kGravity).norm() < 1e-6);
  CHECK(taken(window, 31).empty());
  CHECK(taken(interrupted, 30).empty());
}

TEST_CASE("a bias that becomes known later is removed from windows that ended before") {
  const Eigen::Vector3d bias_rad_per_s(0.01, -0.02, 0.015);
  slam::ImuBuffer imu = standing(bias_rad_per_s);
  slam::GravityWindow window;
  for (int scan = 0; scan <= 30; ++scan) {
    window.add({kScan_s * scan, Pose::Identity()}, Eigen::Vector3d::Zero());
  }
  window.end(30, imu, Eigen::Matrix3d::Identity());
  imu = {};
  window.interrupt();
  window.add({3.1, Pose::Identity()}, bias_rad_per_s);
  const std::vector<slam::FeltGravity> felt = window.take();
  REQUIRE(felt.size() == 1);
  CHECK((felt[0].gravity_mps2 - kGravity).norm() < 1e-6);
}
