#include "hqslam/core/pose.h"

#include <doctest/doctest.h>

#include <numbers>

using hqslam::Pose;

TEST_CASE("roll, pitch and yaw come back from the pose they made") {
  for (double roll = -1.5; roll <= 1.5; roll += 0.5) {
    for (double pitch = -1.4; pitch <= 1.4; pitch += 0.35) {
      for (double yaw = -3.0; yaw <= 3.0; yaw += 0.6) {
        const Pose pose = hqslam::pose_from_xyz_rpy({1, 2, 3}, roll, pitch, yaw);
        const Eigen::Vector3d back = hqslam::roll_pitch_yaw_rad(pose);
        CHECK((back - Eigen::Vector3d(roll, pitch, yaw)).norm() < 1e-12);
        CHECK(pose.linear().determinant() == doctest::Approx(1.0));
      }
    }
  }
}

TEST_CASE("a yaw of 90 degrees turns forward to left") {
  const Pose pose = hqslam::pose_from_xyz_rpy({0, 0, 1}, 0, 0, std::numbers::pi / 2);
  CHECK((pose * Eigen::Vector3d(2, 0, 0) - Eigen::Vector3d(0, 2, 1)).norm() < 1e-12);
}

TEST_CASE("interpolation meets both ends, the middle, and continues beyond") {
  const Pose a = hqslam::pose_from_xyz_rpy({0, 0, 0}, 0.1, -0.2, 0.3);
  const Pose b = a * hqslam::pose_from_xyz_rpy({1, 2, 3}, 0, 0, 0.4);
  CHECK(hqslam::interpolate(a, b, 0.0).isApprox(a, 1e-12));
  CHECK(hqslam::interpolate(a, b, 1.0).isApprox(b, 1e-12));
  const Pose twice = hqslam::interpolate(a, b, 2.0);
  CHECK(hqslam::rotation_angle_rad(a.inverse() * twice) == doctest::Approx(0.8));
  CHECK((twice.translation() - 2.0 * b.translation()).norm() < 1e-12);
}

TEST_CASE("interpolation between equal poses is that pose") {
  const Pose a = hqslam::pose_from_xyz_rpy({4, 5, 6}, 0.3, 0.2, 0.1);
  CHECK(hqslam::interpolate(a, a, 0.3).isApprox(a, 1e-12));
}

TEST_CASE("orthonormalising mends a drifted rotation and leaves the translation") {
  Pose pose = hqslam::pose_from_xyz_rpy({7, 8, 9}, 0.5, 0.6, 0.7);
  const Pose good = pose;
  pose.linear() *= 1.001;
  const Pose mended = hqslam::orthonormalized(pose);
  CHECK(mended.isApprox(good, 1e-9));
}
