#include "alignment/motion_state.h"

#include "slam/steady_drive.h"

using slam::Matrix6;
using slam::MotionState;
using slam::Vector6;

namespace {

constexpr double kLong_s = 1000.0;
const SteadyDrive kScrew{
    pose_from_xyz_rpy({3, 4, 5}, 0.1, 0.2, 0.3), {12, -1, 0.5}, {0.3, -0.2, 0.8}};

MotionState driving(const SteadyDrive& drive) {
  MotionState state;
  state.T_map_sensor = drive.at(0.0);
  state.velocity = {drive.velocity_mps, drive.turn_rad_per_s};
  state.covariance.setZero();
  return state;
}

}  // namespace

TEST_CASE("a steady drive with roll and pitch is predicted exactly") {
  const MotionState later = slam::predicted(driving(kScrew), 0.7, kLong_s, Vector6::Zero());
  CHECK(later.T_map_sensor.isApprox(kScrew.at(0.7), 1e-9));
  CHECK((later.velocity.linear - kScrew.velocity_mps).norm() < 1e-12);
  CHECK(later.covariance.norm() < 1e-12);
}

TEST_CASE("an uncertain velocity becomes an uncertain pose, and so do accelerations") {
  MotionState state;
  state.covariance.setZero();
  state.covariance(6, 6) = 4.0;  // 2 m/s along x
  const Vector6 density = (Vector6() << 0.3, 0, 0, 0, 0, 0.6).finished();
  const MotionState later = slam::predicted(state, 0.5, kLong_s, density);
  // (2 m/s 0.5 s)^2 + 0.3 0.5^3, and so on.
  CHECK(later.covariance(0, 0) == doctest::Approx(1.0 + 0.0375));
  CHECK(later.covariance(0, 6) == doctest::Approx(2.0 + 0.075));
  CHECK(later.covariance(6, 0) == doctest::Approx(later.covariance(0, 6)));
  CHECK(later.covariance(6, 6) == doctest::Approx(4.0 + 0.15));
  CHECK(later.covariance(5, 5) == doctest::Approx(0.075));
  CHECK(later.covariance(1, 1) == 0.0);
}

TEST_CASE("a velocity that the next scan measures changes evenly over the step") {
  MotionState state;
  state.covariance.setZero();
  const Vector6 density = (Vector6() << 0.3, 0, 0, 0, 0, 0).finished();
  const MotionState later = slam::predicted(state, 0.5, kLong_s, density, true);
  CHECK(later.measured_step_s.has_value());
  CHECK(later.covariance(0, 0) == doctest::Approx(0.3 * 0.125 / 3.0));
  CHECK(later.covariance(0, 6) == doctest::Approx(0.3 * 0.25 / 2.0));
  CHECK(later.covariance(6, 6) == doctest::Approx(0.3 * 0.5));
}

TEST_CASE("covariance is carried as random errors of the start are") {
  // Eight errors of the start, driven on in closed form, and their mean square at the end.
  Matrix6 expected = Matrix6::Zero();
  MotionState state = driving(kScrew);
  for (int i = 0; i < 6; ++i) {
    constexpr double kError = 1e-4;
    Vector6 error = Vector6::Constant(0.3 * kError);
    error[i] = kError;
    state.covariance.topLeftCorner<6, 6>() += error * error.transpose();
    SteadyDrive moved = kScrew;
    moved.T_start = kScrew.T_start * exponential(slam::twist_of(error));
    const Vector6 later = slam::vector_of(logarithm(kScrew.at(0.9).inverse() * moved.at(0.9)));
    expected += later * later.transpose();
  }
  const MotionState later = slam::predicted(state, 0.9, kLong_s, Vector6::Zero());
  CHECK((later.covariance.topLeftCorner<6, 6>() - expected).norm() < 1e-3 * expected.norm());
}

TEST_CASE("a velocity that was long ago is not expected any more, and that is uncertainty") {
  const MotionState state = driving({Pose::Identity(), {10, 0, 0}, {0, 0, 1e-9}});
  const Vector6 calm = Vector6::Zero();
  const MotionState soon = slam::predicted(state, 0.9, 1.0, calm);
  CHECK(soon.T_map_sensor.translation().x() == doctest::Approx(9.0));
  CHECK(soon.covariance(0, 0) == doctest::Approx(0.0));
  // A second on as before, then one that fades: 10 m and 10 (1 - exp(-9)) m.
  const MotionState late = slam::predicted(state, 10.0, 1.0, calm);
  CHECK(late.T_map_sensor.translation().x() == doctest::Approx(20.0).epsilon(1e-3));
  CHECK(late.velocity.linear.x() < 0.01);
  // It may as well have gone on: 100 m.
  CHECK(std::sqrt(late.covariance(0, 0)) == doctest::Approx(80.0).epsilon(1e-3));
  CHECK(std::sqrt(late.covariance(6, 6)) == doctest::Approx(10.0).epsilon(1e-3));
}

TEST_CASE("where an innovation leads is as likely as one sigma, as is the velocity to there") {
  MotionState expected;
  expected.covariance *= 1e-9;
  const MotionState wide = slam::with_innovation(expected, {{0.5, 0, 0}, {0, 0, 0.1}}, 0.1);
  CHECK(std::sqrt(wide.covariance(0, 0)) == doctest::Approx(0.5));
  CHECK(wide.covariance(6, 0) / wide.covariance(0, 0) == doctest::Approx(10.0));
  CHECK(std::sqrt(wide.covariance(11, 11)) == doctest::Approx(1.0));
  CHECK(wide.covariance(1, 1) == doctest::Approx(1e-9));
}

TEST_CASE("accelerations are learnt from the drive") {
  slam::AccelerationNoise noise;
  Twist velocity;
  for (int i = 0; i < 300; ++i) {
    const Twist before = velocity;
    velocity.linear.x() = i % 2 == 0 ? 0.2 : 0.0;  // 0.2 m/s more or less every 0.1 s
    noise.learn(before, velocity, 0.1);
  }
  CHECK(noise.density()[0] == doctest::Approx(0.4).epsilon(0.01));
  CHECK(noise.density()[1] > 0.0);
  CHECK(noise.density()[1] < 0.2);
}

TEST_CASE("the adjoint changes the frame of a small motion") {
  const Pose T = pose_from_xyz_rpy({1, -2, 3}, 0.4, -0.5, 0.6);
  const Vector6 e = 1e-3 * (Vector6() << 1, 2, 3, -1, 0.5, 2).finished();
  const Pose moved = T * exponential(slam::twist_of(e)) * T.inverse();
  CHECK((slam::vector_of(logarithm(moved)) - slam::adjoint(T) * e).norm() < 1e-12);
}
