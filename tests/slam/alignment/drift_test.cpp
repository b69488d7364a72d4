#include "alignment/drift.h"

#include "slam/poses.h"

using slam::Matrix6;
using slam::MotionState;
using slam::Vector6;

namespace {

MotionState known_to(double sigma) {
  MotionState state;
  state.covariance.setZero();
  state.covariance.topLeftCorner<6, 6>() = sigma * sigma * Matrix6::Identity();
  return state;
}

slam::Drift sixteen_rows() { return slam::Drift(sensor_preset("os1-16")); }

const MotionState kExact = known_to(0.0);

/// The covariance of the pose of a scan with this state.
Matrix6 covariance_of(const slam::Drift& drift, const MotionState& state,
                      const Pose& motion = Pose::Identity()) {
  return drift.covariance(motion, drift.against_map(state));
}

}  // namespace

TEST_CASE("drift grows with the path, not with the number of scans") {
  slam::Drift in_one_step = sixteen_rows();
  slam::Drift in_ten = sixteen_rows();
  const MotionState state = known_to(0.01);
  in_one_step.grow(at_x(1e-6), state);
  in_ten.grow(at_x(1e-6), state);
  const Matrix6 start = covariance_of(in_one_step, state);
  // Steps so small that the lever of a turn is negligible.
  in_one_step.grow(at_x(0.01), state);
  for (int i = 0; i < 10; ++i) in_ten.grow(at_x(0.001), state);
  const double grown = covariance_of(in_one_step, state)(2, 2) - start(2, 2);
  CHECK(grown > 0.0);
  CHECK(covariance_of(in_ten, state)(2, 2) - start(2, 2) == doctest::Approx(grown).epsilon(1e-3));
}

TEST_CASE("a sensor that is shaken is less certain along and about the axes that it is shaken on") {
  slam::Drift drift = sixteen_rows();  // 0.1 s a scan
  const MotionState state = known_to(0.005);
  const Matrix6 still = covariance_of(drift, state);
  Twist velocity;
  velocity.linear.x() = 8.0;
  drift.learn(velocity);  // a drive that begins is no jolt
  CHECK(covariance_of(drift, state) == still);
  for (int i = 0; i < 500; ++i) {
    velocity.linear.z() = i % 2 == 0 ? 0.1 : -0.1;
    velocity.angular.y() = i % 2 == 0 ? 0.5 : -0.5;
    drift.learn(velocity);
  }
  Matrix6 shaken = still;
  shaken(2, 2) += 0.3 * std::pow(0.1 * 0.2, 2);
  shaken(4, 4) += 0.0097 * std::pow(0.1 * 1.0, 2);
  CHECK(covariance_of(drift, state).isApprox(shaken, 1e-6));
  for (int i = 0; i < 500; ++i) drift.learn(velocity);
  CHECK(covariance_of(drift, state).isApprox(still, 1e-6));
}

TEST_CASE("turns are uneven at once if one changes by more than 0.015 rad in a scan, or many do") {
  for (const double change_rad_per_s : {0.09, 0.2}) {  // 0.1 s a scan
    slam::Drift drift = sixteen_rows();
    const auto learn = [&](double rate_rad_per_s) {
      drift.learn({{0, 0, 0}, {0, 0, rate_rad_per_s}});
      return drift.is_uneven();
    };
    for (int i = 0; i < 20; ++i) CHECK(!learn(0.0));
    CHECK(learn(change_rad_per_s) == (change_rad_per_s > 0.15));
    for (int i = 0; i < 20; ++i) learn(i % 2 == 0 ? 0.0 : change_rad_per_s);
    CHECK(learn(change_rad_per_s) == (change_rad_per_s > 0.1));  // none, but a hand goes on
  }
}

TEST_CASE("half of a turn counts as uneven until a second velocity shows how even turns are") {
  slam::Drift drift = sixteen_rows();  // 0.1 s a scan
  MotionState turning = known_to(0.005);
  const double still_rad2 = covariance_of(drift, turning)(4, 4);
  turning.velocity.angular.y() = 1.0;
  CHECK(covariance_of(drift, turning)(4, 4) - still_rad2 ==
        doctest::Approx(0.0097 * std::pow(0.5 * 0.1, 2)));
  drift.learn(turning.velocity);
  drift.learn(turning.velocity);
  CHECK(covariance_of(drift, turning)(4, 4) == doctest::Approx(still_rad2));
}

TEST_CASE("a start tilts the map within the first metres, by the spacing of the rows") {
  slam::Drift drift = sixteen_rows();
  constexpr double kPath_m = 20.0;
  for (int i = 0; i < 1000; ++i)
    drift.grow(at_x(kPath_m / 1000), kExact, slam::Drift::Level::kByGravity);
  const Matrix6 covariance = covariance_of(drift, kExact);
  const double tilt_rad = 0.019 * 0.0368;
  const double lean_rad2_per_m = std::pow(1.2e-4, 2);  // rest of the lean after levelling
  const auto of_start = [&](int axis) {
    return covariance(axis, axis) - lean_rad2_per_m * kPath_m;
  };
  CHECK(std::sqrt(of_start(3)) / tilt_rad == doctest::Approx(1.0).epsilon(0.03));
  CHECK(std::sqrt(of_start(4)) / tilt_rad == doctest::Approx(1.0).epsilon(0.03));
  CHECK(covariance(5, 5) == 0.0);
  // A pitch over 17 m raises or lowers the end by their product, a lean that grows along it by
  // less.
  const double by_lean_m2 = lean_rad2_per_m * std::pow(kPath_m, 3) / 3.0;
  const double aside_m = std::sqrt(covariance(2, 2) - by_lean_m2);
  CHECK(aside_m > 16.0 * tilt_rad);
  CHECK(aside_m < 19.0 * tilt_rad);
}

TEST_CASE("a start in a hand that turns unevenly is uncertain along the axes without a path") {
  const auto sigma_m = [](double turn_rad_per_s) {
    slam::Drift drift = sixteen_rows();
    Twist velocity;
    for (int i = 0; i < 200; ++i) {
      velocity.angular.z() = i % 2 == 0 ? turn_rad_per_s : -turn_rad_per_s;
      drift.learn(velocity);
    }
    const Pose turned = pose_from_xyz_rpy({0.0, 0.0, 0.0}, 0.0, 0.0, 0.1);
    for (int i = 0; i < 100; ++i) drift.grow(turned, kExact);
    return std::sqrt(drift.state().drift(0, 0));
  };
  // A jolt of 0.1 rad (2 * 0.5 rad/s * 0.1 s) at a lever of 10 m.
  CHECK(sigma_m(0.5) == doctest::Approx(std::sqrt(0.006) * 0.1 * 10.0).epsilon(0.02));
  CHECK(sigma_m(0.0) == 0.0);
}

TEST_CASE("beam errors make it lean by the path's root, less with gravity, more without ground") {
  using enum slam::Drift::Level;
  const auto sigma_after = [](int steps_m, slam::Drift::Level level, int at) {
    slam::Drift drift = sixteen_rows();
    for (int i = 0; i < steps_m; ++i) drift.grow(at_x(1.0), kExact, level);
    return std::sqrt(covariance_of(drift, kExact)(at, at));
  };
  constexpr int kAhead = 0;
  constexpr int kPitch = 4;
  CHECK(sigma_after(400, kByGround, kPitch) == doctest::Approx(5e-4 * 20.0).epsilon(0.01));
  CHECK(sigma_after(400, kByGravity, kPitch) > 1.2e-4 * 20.0);
  CHECK(sigma_after(400, kByGravity, kPitch) < 0.3 * sigma_after(400, kByGround, kPitch));
  constexpr int kUp = 2;
  CHECK(sigma_after(400, kByNothing, kPitch) == doctest::Approx(1.4e-2 * 20.0).epsilon(0.05));
  CHECK(sigma_after(400, kByNothing, kUp) > 0.1 * 400.0);
  CHECK(sigma_after(1, kByNothing, kPitch) < 0.5 * 1.4e-2);  // a scan or two without ground
  CHECK(sigma_after(400, kByGravity, kAhead) == doctest::Approx(3.2e-3 * 20.0).epsilon(0.01));
}

TEST_CASE("the covariance of the last scan is carried to this one") {
  slam::Drift drift = sixteen_rows();  // whose heading is lost, to 0.1 rad
  drift.lose(0.1 * 0.1 * Vector6::Unit(5).asDiagonal().toDenseMatrix(), false);
  CHECK(covariance_of(drift, kExact, at_x(20.0))(1, 1) == doctest::Approx(4.0));
  slam::Drift moved = drift;
  moved.move(at_x(20.0));
  CHECK(covariance_of(moved, kExact).isApprox(covariance_of(drift, kExact, at_x(20.0))));
  // An error of the heading becomes one across the path.
  const double before_m2 = covariance_of(drift, kExact)(1, 1);
  drift.grow(at_x(20.0), kExact);
  CHECK(covariance_of(drift, kExact)(1, 1) - before_m2 >= doctest::Approx(4.0));
  CHECK(covariance_of(drift, kExact)(5, 5) >= doctest::Approx(0.01));
}

TEST_CASE("what is registered against a keyframe of a hardly known pose is no better known") {
  const auto variance_m2 = [](const slam::Drift& drift) { return drift.state().unmeasured(0, 0); };
  slam::Drift drift = sixteen_rows();
  CHECK_FALSE(drift.inherit_uncertainty(0.01 * Matrix6::Identity(), true));
  drift.add_uncertain_keyframe(4.0 * Matrix6::Identity());
  CHECK(drift.inherit_uncertainty(9.0 * Matrix6::Identity(), false));  // less than the keyframe
  CHECK(variance_m2(drift) == 0.0);
  drift.inherit_uncertainty(1.0 * Matrix6::Identity(), false);
  CHECK(variance_m2(drift) == doctest::Approx(3.0));
  drift.inherit_uncertainty(2.0 * Matrix6::Identity(), false);  // nothing of it counts twice
  CHECK(variance_m2(drift) == doctest::Approx(3.0));
  drift.inherit_uncertainty(0.01 * Matrix6::Identity(), true);
  CHECK(variance_m2(drift) == doctest::Approx(3.99));
  CHECK_FALSE(drift.inherit_uncertainty(0.001 * Matrix6::Identity(), true));  // the next are known
}

TEST_CASE("unmeasured motion stays uncertain until a loop removes that, but not the drift since") {
  for (const bool is_carried : {false, true}) {
    CAPTURE(is_carried);
    slam::Drift drift = sixteen_rows();
    drift.lose(9.0 * Matrix6::Identity(), is_carried);
    const slam::DriftState before = drift.state();
    for (int i = 0; i < 10; ++i) drift.grow(at_x(0.5), known_to(0.01));
    CHECK(std::isinf(covariance_of(drift, kExact)(0, 0)) == is_carried);
    CHECK(covariance_of(drift, kExact)(0, 0) >= doctest::Approx(9.0));
    slam::Drift never_lost = sixteen_rows();
    for (int i = 0; i < 10; ++i) never_lost.grow(at_x(0.5), known_to(0.01));
    const slam::DriftState after{before.drift, 1e-4 * Matrix6::Identity(), false};
    slam::Drift found = drift;
    found.set(improved(drift.state(), {before, after}, at_x(5.0), true));
    const double of_drift_m2 = covariance_of(never_lost, kExact)(0, 0);
    CHECK(covariance_of(found, kExact)(0, 0) == doctest::Approx(of_drift_m2 + 1e-4));
    // If tracking was lost again since, nothing follows for the present pose.
    slam::Drift lost_again = drift;
    lost_again.lose(4.0 * Matrix6::Identity(), true);
    lost_again.set(improved(lost_again.state(), {before, after}, at_x(5.0), false));
    CHECK(std::isinf(covariance_of(lost_again, kExact)(0, 0)));
  }
}

TEST_CASE("what a motion adds to a covariance is never negative") {
  const Matrix6 before = 4.0 * Matrix6::Identity();
  Matrix6 expected = before;
  expected(0, 0) = 1.0;
  expected(1, 1) = 9.0;
  const Matrix6 added = slam::growth(before, expected, Pose::Identity());
  CHECK(added(0, 0) == doctest::Approx(0.0));
  CHECK(added(1, 1) == doctest::Approx(5.0));
  CHECK(added(5, 5) == doctest::Approx(0.0));
}
