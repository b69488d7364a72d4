#include "hqslam/slam/options.h"
#include "hqslam/slam/slam.h"
#include "slam/yard_drive.h"

namespace {

constexpr double kSample_s = 0.01;

/// A hand that turns to and fro, up to 200 degrees a second, and walks.
Pose hand_pose(double time_s) {
  return Eigen::Translation3d(2.0 * std::sin(0.5 * time_s), 1.2 * time_s - 8.0, 1.4) *
         pose_from_xyz_rpy(Eigen::Vector3d::Zero(), 0.08 * std::sin(5.0 * time_s),
                           0.1 * std::sin(3.0 * time_s), 1.2 * std::sin(2.9 * time_s));
}

Eigen::Vector3d velocity_mps(double time_s) {
  return (hand_pose(time_s + 1e-4).translation() - hand_pose(time_s - 1e-4).translation()) / 2e-4;
}

ImuSample measured_at(double time_s, const Pose& T_sensor_body) {
  const double begin_s = time_s - 0.5 * kSample_s;
  const double end_s = time_s + 0.5 * kSample_s;
  const Twist turn = logarithm(hand_pose(begin_s).inverse() * hand_pose(end_s));
  const Eigen::Vector3d acceleration = (velocity_mps(end_s) - velocity_mps(begin_s)) / kSample_s;
  const Eigen::Vector3d up(0, 0, kGravity_mps2);
  const Eigen::Vector3d force = hand_pose(time_s).linear().transpose() * (acceleration + up);
  const Eigen::Vector3d bias(0.01, -0.01, 0.005);
  return {time_s, T_sensor_body.linear() * (turn.angular / kSample_s + bias),
          T_sensor_body.linear() * (force + 10.0 * bias)};
}

enum class Imu { kNone, kAll, kWithGap, kClockSetBack, kInG };

/// Scans every `period_s`, of a sensor that is mounted so; the first `begin_s` after the hand
/// began. Out: the worst error of a position.
double worst_inertial_error_m(double period_s, int scans, Imu imu,
                              const slam::MountingOptions& mounting, double begin_s = 0.0) {
  const SensorModel sensor = small_sensor(16, 1024);
  slam::SlamOptions options;
  options.mounting = mounting;
  options.loop_closing.enabled = false;
  slam::Slam slam(sensor, options);
  const Pose T_level_sensor =
      pose_from_xyz_rpy(Eigen::Vector3d::Zero(), mounting.roll_rad, mounting.pitch_rad, 0.0);
  const auto stamp_of = [&](double time_s) {
    return imu == Imu::kClockSetBack && time_s > 1.55 ? time_s - 2.0 : time_s;
  };
  double worst_m = 0.0;
  double sampled_s = -0.5 * period_s;
  for (int i = 0; i < scans; ++i) {
    const double stamp_s = i * period_s;
    std::vector<ImuSample> samples;
    for (; sampled_s <= stamp_s + 0.05; sampled_s += kSample_s) {
      const bool is_in_gap = imu == Imu::kWithGap && sampled_s > 1.0 && sampled_s < 1.3;
      if (imu != Imu::kNone && !is_in_gap) {
        samples.push_back(measured_at(begin_s + sampled_s, T_level_sensor.inverse()));
        samples.back().stamp_s = stamp_of(sampled_s);
        if (imu == Imu::kInG) samples.back().specific_force_mps2 /= kGravity_mps2;
      }
    }
    slam.add_imu(samples);
    const OrganizedCloud scan = Yard().rolling_scan(sensor, [&](double time_s) {
      return hand_pose(begin_s + stamp_s + time_s) * T_level_sensor;
    });
    const slam::ScanReport report = slam.process(scan, stamp_of(stamp_s));
    const Eigen::Vector3d truth_m =
        (hand_pose(begin_s).inverse() * hand_pose(begin_s + stamp_s)).translation();
    worst_m = std::max(worst_m, (report.T_map_sensor.translation() - truth_m).norm());
  }
  return worst_m;
}

/// The geometric mean over drives that begin in upright moments of the hand, at other turns: in one
/// drive the error of the first scan decides.
double mean_worst_error_m(Imu imu, const slam::MountingOptions& mounting) {
  double product_m = 1.0;
  for (const double begin_s : {0.0, M_PI, 2.0 * M_PI}) {
    product_m *= worst_inertial_error_m(0.1, 25, imu, mounting, begin_s);
  }
  return std::cbrt(product_m);
}

}  // namespace

TEST_CASE("an inertial sensor helps to follow 200 degrees a second, also at two scans a second") {
  const double with_m = mean_worst_error_m(Imu::kAll, {});
  CHECK(with_m < 0.029);
  CHECK(with_m < 0.55 * mean_worst_error_m(Imu::kNone, {}));
  const double slow_m = worst_inertial_error_m(0.5, 16, Imu::kAll, {});
  CHECK(slow_m < 0.15);
  CHECK(slow_m < 0.2 * worst_inertial_error_m(0.5, 16, Imu::kNone, {}));
}

TEST_CASE("an inertial sensor upside down with the LiDAR gives the same path") {
  CHECK(mean_worst_error_m(Imu::kAll, {M_PI, 0.1, false}) < 0.05);
}

TEST_CASE("a gap of the inertial data, or a clock of theirs that is set back, is bridged") {
  CHECK(worst_inertial_error_m(0.1, 40, Imu::kWithGap, {}) < 0.05);
  CHECK(worst_inertial_error_m(0.1, 60, Imu::kClockSetBack, {}) < 0.05);
}

TEST_CASE("inertial data whose forces are no gravity, as in another unit, change nothing") {
  CHECK(worst_inertial_error_m(0.1, 40, Imu::kInG, {}) ==
        worst_inertial_error_m(0.1, 40, Imu::kNone, {}));
}
