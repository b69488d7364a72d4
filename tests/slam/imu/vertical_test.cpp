#include "imu/vertical.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "hqslam/core/imu_sample.h"
#include "slam/steady_drive.h"

using namespace hqslam;
using slam::ImuStep;
using slam::Vertical;

namespace {

constexpr double kScan_s = 0.1;
constexpr double kStep_s = 0.01;
const Eigen::Vector3d kGravity(0, 0, -kGravity_mps2);
const Eigen::Vector3d kBias_mps2(0.1, -0.05, 0.02);

/// What is measured between two times of a drive on level ground.
std::vector<ImuStep> measured(const test::SteadyDrive& drive, double from_s, double to_s,
                              const Eigen::Vector3d& bias_mps2) {
  std::vector<ImuStep> steps;
  const auto count = static_cast<int>(std::lround((to_s - from_s) / kStep_s));
  for (int k = 0; k < count; ++k) {
    const Eigen::Matrix3d R = drive.at(from_s + (k + 0.5) * kStep_s).linear();
    steps.push_back(
        {kStep_s, drive.turn_rad_per_s,
         drive.turn_rad_per_s.cross(drive.velocity_mps) - R.transpose() * kGravity + bias_mps2});
  }
  return steps;
}

/// How far the vertical is off after so many scans, degrees, where each registration turns a scan
/// by this much beside the one before.
double lean_deg(const test::SteadyDrive& drive, int scans, const Eigen::Vector3d& bias_mps2,
                double of_scan_deg) {
  Vertical vertical;
  const double of_scan_rad = of_scan_deg * std::numbers::pi / 180.0;
  Eigen::Matrix3d lean = Eigen::Matrix3d::Identity();  // R_found = lean R_true
  for (int scan = 0; scan < scans; ++scan) {
    const double stamp_s = kScan_s * scan;
    const Pose truth = drive.at(stamp_s);
    const Pose of_scan = exponential(Twist{Eigen::Vector3d::Zero(), {0.0, of_scan_rad, 0.0}});
    Pose found = truth;
    found.linear() = lean * truth.linear() * of_scan.linear();
    const auto begin_s = vertical.begin_s();
    const Pose upright = vertical.upright(
        {stamp_s, found}, kGravity,
        begin_s ? measured(drive, *begin_s, stamp_s, bias_mps2) : std::vector<ImuStep>());
    lean = upright.linear() * truth.linear().transpose();
  }
  const double cosine = std::min(1.0, lean(2, 2));
  return std::acos(cosine) * 180.0 / std::numbers::pi;
}

const test::SteadyDrive kStraight{Pose::Identity(), {10, 0, 0}, {0, 0, 1e-6}};
const test::SteadyDrive kRound{Pose::Identity(), {10, 0, 0}, {0, 0, 0.4}};

}  // namespace

TEST_CASE("gravity is felt as it is, less what the sensor accelerates, and a bias as L says") {
  for (const test::SteadyDrive& drive : {kStraight, kRound}) {
    Trajectory poses;
    for (int scan = 0; scan <= 30; ++scan) {
      poses.push_back({kScan_s * scan, drive.at(kScan_s * scan)});
    }
    const auto exact = slam::felt_gravity(poses, measured(drive, 0.0, 3.0, {0, 0, 0}));
    const auto biased = slam::felt_gravity(poses, measured(drive, 0.0, 3.0, kBias_mps2));
    REQUIRE(exact);
    REQUIRE(biased);
    CHECK((exact->gravity_mps2 - kGravity).norm() < 2e-3);
    CHECK((biased->gravity_mps2 - (exact->gravity_mps2 - exact->of_bias * kBias_mps2)).norm() <
          1e-9);
  }
}

TEST_CASE("poses that the forces contradict say nothing of gravity") {
  Trajectory poses;
  for (int scan = 0; scan <= 30; ++scan) {
    poses.push_back({kScan_s * scan, kStraight.at(kScan_s * scan)});
  }
  poses[17].T_map_sensor.translation().y() += 0.5;
  const std::vector<ImuStep> steps = measured(kStraight, 0.0, 3.0, {0, 0, 0});
  CHECK_FALSE(slam::felt_gravity(poses, steps));
  poses[17].T_map_sensor.translation().y() -= 0.5;
  CHECK(slam::felt_gravity(poses, steps));
  CHECK_FALSE(slam::felt_gravity({poses.begin(), poses.begin() + 3}, steps));
  CHECK_FALSE(slam::felt_gravity(poses, {}));
}

TEST_CASE("registrations that lean by a little each are held upright") {
  constexpr int kScans = 600;
  constexpr double kOfScan_deg = 0.01;
  for (const Eigen::Vector3d& bias_mps2 : {Eigen::Vector3d(0, 0, 0), kBias_mps2}) {
    // Left alone it would lean by 6 degrees.
    CHECK(lean_deg(kStraight, kScans, bias_mps2, kOfScan_deg) < 0.6);
  }
}

TEST_CASE("a bias of the accelerometer is not taken for a lean when the sensor turns") {
  // 0.1 m/s^2 are 0.6 degrees, and half a turn would look like twice that.
  CHECK(lean_deg(kRound, 600, kBias_mps2, 0.0) < 0.1);
  CHECK(lean_deg(kStraight, 600, kBias_mps2, 0.0) < 1e-3);
}
