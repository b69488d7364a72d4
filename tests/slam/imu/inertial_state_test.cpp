#include "imu/inertial_state.h"

#include "alignment/scan_information.h"
#include "slam/imu/accelerometer.h"
#include "slam/steady_drive.h"

using namespace hqslam::slam;
using Vector18 = Eigen::Matrix<double, 18, 1>;

namespace {

MotionState moving(const Pose& T_map_sensor, const Eigen::Vector3d& velocity_mps) {
  MotionState state;
  state.T_map_sensor = T_map_sensor;
  state.velocity.linear = velocity_mps;
  return state;
}

const MotionState kMoving = moving(pose_from_xyz_rpy({1, 2, 3}, 0.4, -0.3, 0.9), {1.2, -0.4, 0.3});

/// The state with errors as MotionState and InertialState define them.
InertialPrediction with_error(const MotionState& state, const InertialState& inertial,
                              const Vector18& e) {
  InertialPrediction result{state, inertial};
  result.state.T_map_sensor = state.T_map_sensor * exponential({e.head<3>(), e.segment<3>(3)});
  result.state.velocity.linear += e.segment<3>(6);
  result.inertial.gyroscope_bias_rad_per_s += e.segment<3>(9);
  result.inertial.accelerometer_bias_mps2 += e.segment<3>(12);
  result.inertial.gravity_map_mps2 += e.segment<3>(15);
  return result;
}

Vector18 error_between(const InertialPrediction& a, const InertialPrediction& b) {
  const Twist pose = logarithm(a.state.T_map_sensor.inverse() * b.state.T_map_sensor);
  Vector18 e;
  e << pose.linear, pose.angular, b.state.velocity.linear - a.state.velocity.linear,
      b.inertial.gyroscope_bias_rad_per_s - a.inertial.gyroscope_bias_rad_per_s,
      b.inertial.accelerometer_bias_mps2 - a.inertial.accelerometer_bias_mps2,
      b.inertial.gravity_map_mps2 - a.inertial.gravity_map_mps2;
  return e;
}

std::vector<ImuStep> some_steps(int count) {
  std::vector<ImuStep> steps;
  for (int k = 0; k < count; ++k) {
    const double t = (k + 0.5) * 0.001;
    steps.push_back(
        {0.001,
         {1.5 * std::sin(7 * t), -2.0 * std::cos(5 * t), 3.0 * std::sin(3 * t + 1)},
         {2.0 * std::cos(11 * t), 1.0 - 3.0 * std::sin(4 * t), 9.8 + 4.0 * std::cos(6 * t)}});
  }
  return steps;
}

}  // namespace

TEST_CASE("a steady drive along a screw is integrated to its closed form") {
  const SteadyDrive drive{
      pose_from_xyz_rpy({3, 4, 5}, 0.1, 0.2, 0.3), {2, -1, 0.5}, {0.3, -0.2, 0.8}};
  const InertialState inertial{.gyroscope_bias_rad_per_s = {0.01, 0.02, -0.01},
                               .accelerometer_bias_mps2 = {0.1, -0.2, 0.05},
                               .gravity_map_mps2 = kGravity};
  std::vector<ImuStep> steps;
  for (int k = 0; k < 500; ++k) {
    // a = w x v in the sensor's frame; at the middle of the step.
    const Eigen::Matrix3d R = drive.at(0.001 * (k + 0.5)).linear();
    steps.push_back({0.001, drive.turn_rad_per_s + inertial.gyroscope_bias_rad_per_s,
                     drive.turn_rad_per_s.cross(drive.velocity_mps) - R.transpose() * kGravity +
                         inertial.accelerometer_bias_mps2});
  }
  const InertialPrediction later =
      predicted(moving(drive.at(0.0), drive.velocity_mps), inertial, steps, {7, 8, 9});
  CHECK((later.state.T_map_sensor.translation() - drive.at(0.5).translation()).norm() < 1e-3);
  CHECK(rotation_angle_rad(later.state.T_map_sensor.inverse() * drive.at(0.5)) < 1e-9);
  CHECK((later.state.velocity.linear - drive.velocity_mps).norm() < 5e-3);
  CHECK(later.state.velocity.angular == Eigen::Vector3d(7, 8, 9));
}

TEST_CASE("every error grows into the others as it does when it is made") {
  InertialState inertial{.gravity_map_mps2 = kGravity};
  const auto moved = [&](const InertialPrediction& from) {
    return predicted(from.state, from.inertial, some_steps(200), Eigen::Vector3d::Zero());
  };
  const InertialPrediction exact = moved({kMoving, inertial});
  const Matrix18 noise = exact.inertial.covariance;
  for (int i = 0; i < 18; ++i) {
    CAPTURE(i);
    InertialState uncertain = inertial;
    uncertain.covariance(i, i) = 1.0;
    const Matrix18 grown = moved({kMoving, uncertain}).inertial.covariance - noise;
    constexpr double kSmall = 1e-5;
    const Vector18 made =
        error_between(exact, moved(with_error(kMoving, inertial, kSmall * Vector18::Unit(i)))) /
        kSmall;
    CHECK((grown - made * made.transpose()).norm() < 0.01 * made.squaredNorm());
  }
}

TEST_CASE("at first gravity is against the specific force, and the pose as sure as it was") {
  MotionState state = moving(pose_from_xyz_rpy({1, 2, 3}, 0.2, 0, 0), {0, 0, 0});
  state.covariance(4, 4) = 0.25;
  const Eigen::Vector3d force = state.T_map_sensor.linear().transpose() * Eigen::Vector3d(0, 0, 10);
  const InertialState inertial = first_inertial_state(state, force);
  CHECK(inertial.gravity_map_mps2.isApprox(kGravity, 1e-9));
  CHECK(inertial.covariance(4, 4) == 0.25);
  CHECK(inertial.covariance.diagonal().tail<9>().minCoeff() > 0.0);
}

TEST_CASE("biases and gravity are estimated from a hand's turns, scan by scan") {
  const Eigen::Vector3d gyroscope(0.008, -0.006, 0.01);
  const Eigen::Vector3d accelerometer(0.08, -0.05, 0.06);
  const auto pose_at = [](double time_s) {
    return pose_from_xyz_rpy({std::sin(time_s), 0.3 * std::cos(2 * time_s), 0.1 * time_s},
                             0.6 * std::sin(1.3 * time_s), 0.7 * std::sin(1.7 * time_s),
                             1.5 * std::sin(0.9 * time_s));
  };
  const auto velocity_at = [&](double time_s) -> Eigen::Vector3d {
    return (pose_at(time_s + 1e-4).translation() - pose_at(time_s - 1e-4).translation()) / 2e-4;
  };
  MotionState state = unknown_motion(pose_at(0.0));
  InertialState inertial = first_inertial_state(state, {0, 0, 9.8});
  for (int scan = 1; scan <= 600; ++scan) {
    std::vector<ImuStep> steps;
    for (int k = 0; k < 10; ++k) {
      const double t = 0.1 * (scan - 1) + 0.01 * (k + 0.5);
      const Twist turn = logarithm(pose_at(t - 0.005).inverse() * pose_at(t + 0.005));
      const Eigen::Vector3d acceleration = (velocity_at(t + 0.005) - velocity_at(t - 0.005)) / 0.01;
      steps.push_back(
          {0.01, turn.angular / 0.01 + gyroscope,
           pose_at(t).linear().transpose() * (acceleration - kGravity) + accelerometer});
    }
    const auto prediction = predicted(state, inertial, steps, Eigen::Vector3d::Zero());
    // A registration that finds the pose exactly.
    state = ExpectedState(prediction.state).given(pose_at(0.1 * scan));
    state.covariance *= 1e-6;
    const Matrix6 of_scan = 1e6 * prediction.state.covariance.topLeftCorner<6, 6>().inverse();
    inertial = corrected(prediction, state, of_scan, of_scan);
  }
  // Slowly, since registrations in rooms are often wrong: a fifth is left after a minute.
  CHECK((inertial.gyroscope_bias_rad_per_s - gyroscope).norm() < 0.2 * gyroscope.norm());
  CHECK((inertial.accelerometer_bias_mps2 - accelerometer).norm() < 0.03);
  CHECK((inertial.gravity_map_mps2 - kGravity).norm() < 0.03);
  CHECK(inertial.covariance.isApprox(inertial.covariance.transpose(), 1e-9));
  CHECK(inertial.covariance.diagonal().minCoeff() > 0.0);
}

TEST_CASE("a scan corrects as a Kalman update by its own information, and not where it has none") {
  const InertialState inertial = first_inertial_state(kMoving, {0.1, 0.2, 9.7});
  const std::vector<ImuStep> steps(10, {0.01, {0.1, -0.2, 0.3}, {0.4, 0.1, 9.9}});
  const InertialPrediction prediction =
      predicted(kMoving, inertial, steps, Eigen::Vector3d::Zero());
  MotionState expected = prediction.state;
  SUBCASE("searched at the prediction") {}
  SUBCASE("searched farther away, at the pose of the odometry") {
    expected = with_innovation(expected, {{0.3, 0.1, 0.2}, {0.1, 0.1, 0.1}}, 0.1);
  }
  Vector6 z;  // the pose by the scan alone, relative to the prediction
  z << 0.01, 0.0, 0.03, 1e-3, -2e-3, 1e-3;
  Vector6 information;  // nothing along y
  information << 2500.0, 0.0, 1e4, 2.5e5, 1e6, 1e5;
  ScanInformation scan;
  scan.information = information.asDiagonal();
  scan.gradient = -scan.information * z;
  const ExpectedState prior(expected);
  MotionState joined = expected;
  prior.improve(joined, scan);
  joined.covariance = prior.covariance(scan.information);
  const InertialState found = corrected(prediction, joined, scan.information, scan.information);

  const Matrix18& P = prediction.inertial.covariance;
  Vector6 sigma;
  sigma << Eigen::Vector3d::Constant(0.02), Eigen::Vector3d::Constant(4e-3);
  information[1] = 1e-9;
  Matrix6 S = P.topLeftCorner<6, 6>();
  S.diagonal() += information.cwiseInverse() + sigma.cwiseAbs2();
  const Eigen::Matrix<double, 18, 6> K = P.leftCols<6>() * S.inverse();
  CHECK(found.covariance.isApprox(P - K * S * K.transpose(), 1e-6));
  const Eigen::Vector3d learnt =
      found.gyroscope_bias_rad_per_s - prediction.inertial.gyroscope_bias_rad_per_s;
  CHECK(learnt.isApprox((K * z).segment<3>(9), 1e-3));
}

TEST_CASE("feigned information about a direction leaves the covariance as predicted there") {
  const InertialPrediction prediction =
      predicted(kMoving, first_inertial_state(kMoving, {0.1, 0.2, 9.7}), some_steps(10),
                Eigen::Vector3d::Zero());
  Matrix6 known = 1e6 * Matrix6::Identity();
  known(2, 2) = 0.0;  // of the height only errors of normals speak
  const Matrix18 after =
      corrected(prediction, prediction.state, 1e6 * Matrix6::Identity(), known).covariance;
  const Matrix18& before = prediction.inertial.covariance;
  CHECK(after(0, 0) < 0.5 * before(0, 0));
  CHECK(after(2, 2) > 0.9 * before(2, 2));
}

TEST_CASE("after a gap biases and gravity are unchanged and uncorrelated with the pose") {
  const InertialPrediction before = predicted(kMoving, first_inertial_state(kMoving, {1, 2, 9}),
                                              some_steps(100), Eigen::Vector3d::Zero());
  const MotionState found = unknown_motion(kMoving.T_map_sensor);
  const InertialState after = kept(before.inertial, found);
  CHECK(after.gravity_map_mps2 == before.inertial.gravity_map_mps2);
  CHECK(after.covariance.bottomRightCorner<9, 9>() ==
        before.inertial.covariance.bottomRightCorner<9, 9>());
  CHECK(after.covariance.topLeftCorner<9, 9>() == found.covariance.topLeftCorner<9, 9>());
  CHECK(after.covariance.topRightCorner<9, 9>().isZero());
}

TEST_CASE("gravity turns with the map") {
  InertialState inertial{.gravity_map_mps2 = kGravity};
  inertial.covariance(15, 15) = 4.0;
  turn(inertial, Eigen::AngleAxisd(M_PI_2, Eigen::Vector3d::UnitY()).matrix());
  CHECK((inertial.gravity_map_mps2 - Eigen::Vector3d(-kGravity_mps2, 0, 0)).norm() < 1e-9);
  CHECK(inertial.covariance(17, 17) == doctest::Approx(4.0));
}
