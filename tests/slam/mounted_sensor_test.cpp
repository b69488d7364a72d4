#include "hqslam/slam/options.h"
#include "hqslam/slam/slam.h"
#include "slam/yard_drive.h"

namespace {

constexpr int kMountedScans = 25;

Pose level_from_sensor(const slam::MountingOptions& mounting) {
  return pose_from_xyz_rpy(Eigen::Vector3d::Zero(), mounting.roll_rad, mounting.pitch_rad, 0.0);
}

/// Scan `i` of the yard's drive by a sensor that leans so.
OrganizedCloud leaning_scan(const SensorModel& sensor, const slam::MountingOptions& leans, int i) {
  const Pose T_level_sensor = level_from_sensor(leans);
  return Yard().rolling_scan(sensor, [&](double time_s) {
    return drive_pose(i * kDrivePeriod_s + time_s) * T_level_sensor;
  });
}

struct MountedDrive {
  slam::Slam slam;
  int located = 0;
  int fewest_ground_points = 1 << 30;
  Twist last_velocity = {};
};

MountedDrive driven(const slam::MountingOptions& leans, const slam::MountingOptions& given) {
  const SensorModel sensor = small_sensor(16, 512);
  slam::SlamOptions options;
  options.mounting = given;
  MountedDrive drive{slam::Slam(sensor, options)};
  for (int i = 0; i < kMountedScans; ++i) {
    const slam::ScanReport report =
        drive.slam.process(leaning_scan(sensor, leans, i), i * kDrivePeriod_s);
    drive.located += is_registered(report.mapping_status) ? 1 : 0;
    drive.last_velocity = report.velocity;
    drive.fewest_ground_points = std::min(drive.fewest_ground_points, report.ground_points);
  }
  return drive;
}

/// The worst error of the sensor's poses in a map whose frame is that of the first scan, turned
/// level.
double worst_pose_error(const Trajectory& trajectory, const Pose& T_level_sensor) {
  double worst = 0.0;
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const Pose truth = drive_pose(0).inverse() *
                       drive_pose(static_cast<double>(i) * kDrivePeriod_s) * T_level_sensor;
    const Pose error = truth.inverse() * trajectory[i].T_map_sensor;
    worst = std::max({worst, error.translation().norm(), rotation_angle_rad(error)});
  }
  return worst;
}

}  // namespace

TEST_CASE("a sensor that leans, or hangs, is followed if it is known, in a map that is level") {
  for (const slam::MountingOptions& so :
       {slam::MountingOptions{-0.1, 0.2, false}, {std::numbers::pi, 0.1, false}}) {
    CAPTURE(so.roll_rad);
    const MountedDrive drive = driven(so, so);
    CHECK(drive.located == kMountedScans);
    CHECK(drive.fewest_ground_points > 300);
    CHECK(worst_pose_error(drive.slam.trajectory(), level_from_sensor(so)) < 0.04);
    const auto truth = [&](int scan) {
      return Pose(drive_pose(scan * kDrivePeriod_s) * level_from_sensor(so));
    };
    const Twist step = logarithm(truth(kMountedScans - 2).inverse() * truth(kMountedScans - 1));
    CHECK((drive.last_velocity.linear - step.linear / kDrivePeriod_s).norm() +
              (drive.last_velocity.angular - step.angular / kDrivePeriod_s).norm() <
          0.3);
  }
}

TEST_CASE("a sensor that leans without being stated is followed, in a map that is level") {
  const slam::MountingOptions leans{-0.1, 0.3, false};
  const MountedDrive drive = driven(leans, {});
  CHECK(drive.located == kMountedScans);
  CHECK(drive.slam.mounting().estimated);
  CHECK(worst_pose_error(drive.slam.trajectory(), level_from_sensor(leans)) < 0.04);
}

TEST_CASE("hands that lean in the first scan and turn upright keep the ground in view") {
  const SensorModel sensor = small_sensor(16, 512);
  slam::Slam slam(sensor);
  int fewest_ground_points = 1 << 30;
  for (int i = 0; i < 20; ++i) {
    const double pitch_rad = 0.3 - 0.025 * i;  // from 17 degrees forward to 10 backward
    const slam::ScanReport report =
        slam.process(leaning_scan(sensor, {0.0, pitch_rad, false}, i), i * kDrivePeriod_s);
    fewest_ground_points = std::min(fewest_ground_points, report.ground_points);
  }
  CHECK(slam.mounting().estimated);
  CHECK(fewest_ground_points > 2500);
}

TEST_CASE("a sensor on its side is refused") {
  slam::SlamOptions options;
  options.mounting.pitch_rad = 1.3;
  CHECK_THROWS_WITH_AS(slam::Slam(small_sensor(), options),
                       "SLAM option mounting.pitch_rad is 1.3, expected a sensor within 60 degrees "
                       "of upright or upside down",
                       Error);
}
