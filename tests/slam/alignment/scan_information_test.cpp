// Ceres first: doctest's CHECK would otherwise be glog's.
#include "alignment/scan_information.h"

#include "slam/random_unit.h"

using namespace hqslam::slam;

namespace {

constexpr double kSigma_m = 0.02;

/// Points on random planes about a sensor with this orientation.
std::vector<PlaneConstraint> constraints_about(const Eigen::Matrix3d& R, int count) {
  std::mt19937 generator(7);
  std::vector<PlaneConstraint> result;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d point_m = R * (20.0 * random_vector(generator));
    const Eigen::Vector3d normal =
        (random_vector(generator) + Eigen::Vector3d(0, 0, 0.1)).normalized();
    result.push_back({point_m, normal, normal.dot(point_m) + 0.05 * random_unit(generator),
                      (0.5 + 0.01 * (i % 50)) / kSigma_m});
  }
  return result;
}

/// Half the weighted squares, if the sensor is moved by exp(e) in its own frame.
double cost(const std::vector<PlaneConstraint>& constraints, const Eigen::Matrix3d& R,
            const Vector6& e) {
  Pose T = Pose::Identity();
  T.linear() = R;
  const Pose moved = T * exponential(twist_of(e)) * T.inverse();
  double sum = 0.0;
  for (const PlaneConstraint& c : constraints) {
    sum += 0.5 * std::pow(c.weight * (c.normal.dot(moved * c.point_m) - c.offset_m), 2);
  }
  return sum;
}

MotionState standing(double sigma_m, double sigma_mps) {
  MotionState state;
  state.covariance.diagonal() << Vector6::Constant(sigma_m * sigma_m),
      Vector6::Constant(sigma_mps * sigma_mps);
  return state;
}

/// One step from the expected state, with the covariance after it.
MotionState registered(const MotionState& expected, const std::vector<PlaneConstraint>& planes) {
  const Eigen::Matrix3d level = Eigen::Matrix3d::Identity();
  const ExpectedState prior(expected);
  MotionState state = expected;
  prior.improve(state, scan_information(planes, level));
  state.covariance = prior.covariance(known_information(planes, level).information);
  return state;
}

}  // namespace

TEST_CASE("the gradient and the information are those of the weighted squares") {
  const Eigen::Matrix3d R = pose_from_xyz_rpy({0, 0, 0}, 0.2, -0.4, 1.1).linear();
  const auto constraints = constraints_about(R, 60);
  const ScanInformation found = scan_information(constraints, R);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 6; ++i) {
    const Vector6 e = kStep * Vector6::Unit(i);
    const double slope = (cost(constraints, R, e) - cost(constraints, R, -e)) / (2 * kStep);
    CHECK(found.gradient[i] == doctest::Approx(slope).epsilon(1e-5));
  }
  // Where all residuals are zero, information is curvature.
  auto exact = constraints;
  for (PlaneConstraint& c : exact) c.offset_m = c.normal.dot(c.point_m);
  const Vector6 e = 1e-4 * (Vector6() << 1, -2, 3, 0.1, 0.2, -0.3).finished();
  CHECK(cost(exact, R, e) ==
        doctest::Approx(0.5 * e.dot(scan_information(exact, R).information * e)).epsilon(1e-3));
}

TEST_CASE("the pose is between the expected and the measured one by their variances") {
  // A wall 0.3 m nearer than expected, known to 0.1 m; the place was expected to 0.2 m.
  const std::vector<PlaneConstraint> wall = {{{5.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 5.3, 10.0}};
  const MotionState found = registered(standing(0.2, 0.0001), wall);
  CHECK(found.T_map_sensor.translation().x() == doctest::Approx(0.3 * 0.04 / (0.04 + 0.01)));
  CHECK(found.covariance(0, 0) == doctest::Approx(0.04 * 0.01 / (0.04 + 0.01)));
  // Without information about the side.
  CHECK(found.T_map_sensor.translation().y() == doctest::Approx(0.0));
  CHECK(found.covariance(1, 1) == doctest::Approx(0.04));
}

TEST_CASE("the velocity that leads to the pose is found with it") {
  // An unknown velocity over 0.1 s, and a measurement 0.5 m ahead.
  MotionState start;
  start.covariance.setZero();
  start.covariance.diagonal() << Vector6::Constant(1e-8), Vector6::Constant(100.0);
  const MotionState expected = predicted(start, 0.1, 1.0, Vector6::Constant(1e-6));
  std::vector<PlaneConstraint> walls;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-5.0, 5.0}) {
      for (const double aside : {-5.0, 5.0}) {
        const Eigen::Vector3d normal = Eigen::Vector3d::Unit(axis);
        const Eigen::Vector3d point_m =
            side * normal + aside * Eigen::Vector3d::Unit((axis + 1) % 3);
        walls.push_back({point_m, normal, side + (axis == 0 ? 0.5 : 0.0), 1000.0});
      }
    }
  }
  const ExpectedState prior(expected);
  const MotionState found = registered(expected, walls);
  CHECK(found.T_map_sensor.translation().x() == doctest::Approx(0.5).epsilon(1e-4));
  CHECK(found.velocity.linear.x() == doctest::Approx(5.0).epsilon(1e-3));
  CHECK(found.velocity.linear.y() == doctest::Approx(0.0));
  CHECK(prior.given(found.T_map_sensor).velocity.linear.x() == doctest::Approx(5.0).epsilon(1e-3));
}

TEST_CASE("along a tunnel whose normals lean at random nothing is known, across it all is") {
  constexpr double kTilt = 0.05;
  std::mt19937 generator(9);
  std::normal_distribution<double> lean(0.0, kTilt);
  std::vector<PlaneConstraint> tunnel;
  for (int i = 0; i < 1200; ++i) {
    const double along_m = 40.0 * random_unit(generator);
    const Eigen::Vector3d across = i % 2 == 0 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d normal =
        (across + lean(generator) * Eigen::Vector3d::UnitX()).normalized();
    const Eigen::Vector3d point_m =
        along_m * Eigen::Vector3d::UnitX() +
        2.5 * (random_unit(generator) * Eigen::Vector3d(0, 1, 1) + across);
    tunnel.push_back(
        {point_m, normal, normal.dot(point_m), 1.0 / kSigma_m, kTilt * Eigen::Vector3d::UnitX()});
  }
  const ScanInformation found = scan_information(tunnel, Eigen::Matrix3d::Identity());
  CHECK(1.0 / std::sqrt(found.information(0, 0)) < 0.02);  // feigned: centimetres
  const auto [known, is_complete] = known_information(tunnel, Eigen::Matrix3d::Identity());
  CHECK_FALSE(is_complete);
  CHECK(known(0, 0) < 0.01 * found.information(0, 0));
  CHECK(known(1, 1) > 0.99 * found.information(1, 1));
  CHECK(known(2, 2) > 0.99 * found.information(2, 2));
  const MotionState state = registered(standing(0.5, 1.0), tunnel);
  CHECK(std::sqrt(state.covariance(0, 0)) > 0.45);  // as before the scan
  CHECK(std::sqrt(state.covariance(1, 1)) < 0.01);
}
