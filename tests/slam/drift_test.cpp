#include "drift.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace hqslam;
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

Pose ahead(double x_m) { return pose_from_xyz_rpy({x_m, 0, 0}, 0, 0, 0); }

}  // namespace

TEST_CASE("drift grows with the path, not with the number of scans") {
  slam::Drift in_one_step;
  slam::Drift in_ten;
  const MotionState state = known_to(0.01);
  in_one_step.locate(ahead(1e-6), state);
  in_ten.locate(ahead(1e-6), state);
  const Matrix6 start = in_one_step.covariance(state);
  // Steps so small that the lever of a turn is none.
  in_one_step.locate(ahead(0.01), state);
  for (int i = 0; i < 10; ++i) in_ten.locate(ahead(0.001), state);
  const double grown = in_one_step.covariance(state)(2, 2) - start(2, 2);
  CHECK(grown > 0.0);
  CHECK(in_ten.covariance(state)(2, 2) - start(2, 2) == doctest::Approx(grown).epsilon(1e-3));
}

TEST_CASE("a heading that is off leads aside") {
  slam::Drift drift;
  MotionState lost = known_to(0.0);
  lost.covariance(5, 5) = 0.1 * 0.1;
  drift.lose(lost);
  const MotionState exact = known_to(0.0);
  const double before_m2 = drift.covariance(exact)(1, 1);
  drift.locate(ahead(20.0), exact);
  CHECK(drift.covariance(exact)(1, 1) - before_m2 >= doctest::Approx(4.0));
  CHECK(drift.covariance(exact)(5, 5) >= doctest::Approx(0.01));
}

TEST_CASE("what nothing measured stays uncertain for good") {
  slam::Drift drift;
  const MotionState exact = known_to(0.0);
  const double before_m2 = drift.covariance(exact)(0, 0);
  drift.lose(known_to(3.0));
  for (int i = 0; i < 100; ++i) drift.locate(ahead(0.5), exact);
  CHECK(drift.covariance(exact)(0, 0) - before_m2 >= doctest::Approx(9.0));
}
