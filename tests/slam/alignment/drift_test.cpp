#include "alignment/drift.h"

#include <doctest/doctest.h>

#include <cmath>

#include "hqslam/core/sensor_model.h"

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

slam::Drift sixteen_rows() { return slam::Drift(sensor_preset("os1-16")); }

const Pose kHere = Pose::Identity();

Pose ahead(double x_m) { return pose_from_xyz_rpy({x_m, 0, 0}, 0, 0, 0); }

}  // namespace

TEST_CASE("drift grows with the path, not with the number of scans") {
  slam::Drift in_one_step = sixteen_rows();
  slam::Drift in_ten = sixteen_rows();
  const MotionState state = known_to(0.01);
  in_one_step.locate(ahead(1e-6), state);
  in_ten.locate(ahead(1e-6), state);
  const Matrix6 start = in_one_step.covariance(kHere, state);
  // Steps so small that the lever of a turn is none.
  in_one_step.locate(ahead(0.01), state);
  for (int i = 0; i < 10; ++i) in_ten.locate(ahead(0.001), state);
  const double grown = in_one_step.covariance(kHere, state)(2, 2) - start(2, 2);
  CHECK(grown > 0.0);
  CHECK(in_ten.covariance(kHere, state)(2, 2) - start(2, 2) ==
        doctest::Approx(grown).epsilon(1e-3));
}

TEST_CASE("a scan against the map: each axis by its factor, less where rows are dense") {
  const MotionState state = known_to(0.01);
  const Matrix6 sixteen = sixteen_rows().covariance(kHere, state);
  CHECK(sixteen(0, 0) / 1e-4 == doctest::Approx(20.0).epsilon(0.02));
  CHECK(sixteen(2, 2) / 1e-4 == doctest::Approx(7.3).epsilon(0.02));
  CHECK(sixteen(4, 4) / 1e-4 == doctest::Approx(5.3).epsilon(0.02));
  CHECK(sixteen(5, 5) / 1e-4 == doctest::Approx(9.2).epsilon(0.02));
  const SensorModel dense = sensor_preset("os1-64");
  const Matrix6 sixty_four = slam::Drift(dense).covariance(kHere, state);
  // 63 steps instead of 15 over about the same angle: (15/63)^0.75.
  CHECK(sixty_four(0, 0) / sixteen(0, 0) == doctest::Approx(0.341).epsilon(0.05));
  SensorModel lifted = dense;
  lifted.measured_rows = selection_for(64, 16);
  CHECK(slam::Drift(lifted).covariance(kHere, state).isApprox(sixteen, 0.05));
}

TEST_CASE("a start tilts the map within the first metres, by the spacing of the rows") {
  slam::Drift drift = sixteen_rows();
  const MotionState exact = known_to(0.0);
  for (int i = 0; i < 1000; ++i) drift.locate(ahead(0.02), exact);
  const double tilt_rad = 0.0244 * 0.0368;
  CHECK(std::sqrt(drift.covariance(kHere, exact)(3, 3)) / tilt_rad ==
        doctest::Approx(1.0).epsilon(0.03));
  CHECK(std::sqrt(drift.covariance(kHere, exact)(4, 4)) / tilt_rad ==
        doctest::Approx(1.0).epsilon(0.03));
  CHECK(drift.covariance(kHere, exact)(5, 5) == 0.0);
  // A pitch for 18 m or so leads up or down by that times the way.
  const double aside_m = std::sqrt(drift.covariance(kHere, exact)(2, 2));
  CHECK(aside_m > 17.0 * tilt_rad);
  CHECK(aside_m < 20.0 * tilt_rad);
}

TEST_CASE("what is known of the last scan is carried along to this one") {
  slam::Drift drift = sixteen_rows();
  MotionState lost = known_to(0.0);
  lost.covariance(5, 5) = 0.1 * 0.1;
  drift.lose(lost);
  const MotionState exact = known_to(0.0);
  CHECK(drift.covariance(ahead(20.0), exact)(1, 1) == doctest::Approx(4.0));
  slam::Drift moved = drift;
  moved.move(ahead(20.0));
  CHECK(moved.covariance(kHere, exact).isApprox(drift.covariance(ahead(20.0), exact)));
}

TEST_CASE("a heading that is off leads aside") {
  slam::Drift drift = sixteen_rows();
  MotionState lost = known_to(0.0);
  lost.covariance(5, 5) = 0.1 * 0.1;
  drift.lose(lost);
  const MotionState exact = known_to(0.0);
  const double before_m2 = drift.covariance(kHere, exact)(1, 1);
  drift.locate(ahead(20.0), exact);
  CHECK(drift.covariance(kHere, exact)(1, 1) - before_m2 >= doctest::Approx(4.0));
  CHECK(drift.covariance(kHere, exact)(5, 5) >= doctest::Approx(0.01));
}

TEST_CASE("what nothing measured stays uncertain for good") {
  slam::Drift drift = sixteen_rows();
  const MotionState exact = known_to(0.0);
  const double before_m2 = drift.covariance(kHere, exact)(0, 0);
  drift.lose(known_to(3.0));
  for (int i = 0; i < 100; ++i) drift.locate(ahead(0.5), exact);
  CHECK(drift.covariance(kHere, exact)(0, 0) - before_m2 >= doctest::Approx(9.0));
}
