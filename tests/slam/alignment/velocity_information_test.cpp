// Ceres first: doctest's CHECK would otherwise be glog's.
#include "alignment/velocity_information.h"

#include "slam/random_unit.h"

using slam::PlaneConstraint;
using slam::Vector6;

namespace {

const Eigen::Matrix3d kLevel = Eigen::Matrix3d::Identity();
/// What the sensor does during the scan, and the error of the velocity that corrected it for
/// motion.
const Vector6 kVelocityError = (Vector6() << 0.3, -0.2, 0.1, 0.05, -0.1, 0.2).finished();

/// Points on random planes, captured within 0.05 s of the stamp and corrected for motion with a
/// velocity that was wrong by kVelocityError; the pose at the stamp is right.
std::vector<PlaneConstraint> wrongly_corrected(bool with_times) {
  std::mt19937 generator(11);
  const auto random = [&] { return random_vector(generator); };
  std::vector<PlaneConstraint> result;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d true_m = 20.0 * random();
    const double time_s = 0.05 * random_unit(generator);
    const Pose missing = exponential(time_s * slam::twist_of(kVelocityError));
    const Eigen::Vector3d normal = (random() + Eigen::Vector3d(0, 0, 0.1)).normalized();
    PlaneConstraint plane{missing.inverse() * true_m, normal, normal.dot(true_m), 50.0};
    if (with_times) plane.time_offset_s = time_s;
    result.push_back(plane);
  }
  return result;
}

}  // namespace

TEST_CASE("a scan measures the velocity by which it should have been corrected for motion") {
  const auto constraints = wrongly_corrected(true);
  slam::MotionState expected = slam::unknown_motion(Pose::Identity());
  expected.covariance *= 1e4;
  expected.measured_step_s = 0.1;
  const slam::ScanInformation pose = slam::scan_information(constraints, kLevel);
  const slam::VelocityInformation velocity = slam::velocity_information(constraints, kLevel, pose);
  slam::MotionState found = expected;
  slam::ExpectedState(expected).improve(found, pose, &velocity);
  CHECK((slam::vector_of(found.velocity) - kVelocityError).norm() < 0.01);
  // It has changed by that since the scan before, when it was expected to be 0.
  CHECK(slam::vector_of(found.acceleration).isApprox(10.0 * slam::vector_of(found.velocity)));
  CHECK(slam::vector_of(logarithm(found.T_map_sensor)).norm() < 1e-3);
}

TEST_CASE("a scan without times of capture measures no velocity") {
  const auto constraints = wrongly_corrected(false);
  const slam::VelocityInformation found =
      slam::velocity_information(constraints, kLevel, slam::scan_information(constraints, kLevel));
  CHECK(found.with_pose.isZero());
  CHECK(found.of_velocity.isZero());
  CHECK(found.gradient.isZero());
}

TEST_CASE("of points captured at one time the velocity remains unknown beside the pose") {
  auto constraints = wrongly_corrected(true);
  for (PlaneConstraint& plane : constraints) plane.time_offset_s = 0.05;
  const slam::ScanInformation pose = slam::scan_information(constraints, kLevel);
  const slam::VelocityInformation found = slam::velocity_information(constraints, kLevel, pose);
  const slam::Matrix6 rest = found.of_velocity - found.with_pose.transpose() *
                                                     pose.information.inverse() * found.with_pose;
  CHECK(rest.norm() < 1e-6 * found.of_velocity.norm());
}
