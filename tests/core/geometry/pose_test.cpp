#include "hqslam/core/pose.h"

#include "testing.h"

TEST_CASE("roll, pitch and yaw come back from the pose they made, a yaw of 90 degrees turns left") {
  for (double roll = -1.5; roll <= 1.5; roll += 0.5) {
    for (double pitch = -1.4; pitch <= 1.4; pitch += 0.35) {
      for (double yaw = -3.0; yaw <= 3.0; yaw += 0.6) {
        const Pose pose = pose_from_xyz_rpy({1, 2, 3}, roll, pitch, yaw);
        CHECK((roll_pitch_yaw_rad(pose) - Eigen::Vector3d(roll, pitch, yaw)).norm() < 1e-12);
        CHECK(pose.linear().determinant() == doctest::Approx(1.0));
      }
    }
  }
  const Pose left = pose_from_xyz_rpy({0, 0, 1}, 0, 0, std::numbers::pi / 2);
  CHECK((left * Eigen::Vector3d(2, 0, 0) - Eigen::Vector3d(0, 2, 1)).norm() < 1e-12);
}

TEST_CASE("interpolation meets both ends, the middle, continues beyond, and stays at equal poses") {
  const Pose a = pose_from_xyz_rpy({0, 0, 0}, 0.1, -0.2, 0.3);
  const Pose b = a * pose_from_xyz_rpy({1, 2, 3}, 0, 0, 0.4);
  CHECK(interpolate(a, b, 0.0).isApprox(a, 1e-12));
  CHECK(interpolate(a, b, 1.0).isApprox(b, 1e-12));
  const Pose twice = interpolate(a, b, 2.0);
  CHECK(rotation_angle_rad(a.inverse() * twice) == doctest::Approx(0.8));
  const Pose step = a.inverse() * b;
  CHECK(twice.isApprox(a * step * step, 1e-12));
  CHECK(interpolate(b, b, 0.3).isApprox(b, 1e-12));
}

TEST_CASE("a constant twist is the limit of many small steps, of any axis and size") {
  for (const double size : {1e-9, 1e-5, 1e-3, 0.3, 3.0}) {
    const Eigen::Vector3d v = size * Eigen::Vector3d(3.0, -1.0, 0.5);
    const Eigen::Vector3d w = size * Eigen::Vector3d(0.3, 0.5, -0.8);
    // Each step: the differential equation dT = T [twist] dt, solved by squaring 2^-30 of it.
    constexpr int kHalvings = 30;
    Eigen::Matrix4d T = Eigen::Matrix4d::Zero();
    T.topLeftCorner<3, 3>() << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    T.topRightCorner<3, 1>() = v;
    T = (T / std::ldexp(1.0, kHalvings)).eval();
    // (I + A)^2 = I + (2 A + A^2): the identity is left out, so that nothing small is lost.
    for (int k = 0; k < kHalvings; ++k) T = (2.0 * T + T * T).eval();
    T += Eigen::Matrix4d::Identity();
    CAPTURE(size);
    CHECK((exponential({v, w}).matrix() - T).norm() < 1e-8 * size * (1.0 + size));
  }
}

TEST_CASE("the logarithm undoes the exponential") {
  for (const double size : {0.0, 1e-12, 9e-5, 1.1e-4, 0.3, 3.1}) {
    const Twist twist{{3.0, -1.0, 0.5}, size * Eigen::Vector3d(0.3, 0.5, -0.8).normalized()};
    const Twist back = logarithm(exponential(twist));
    CAPTURE(size);
    CHECK((back.linear - twist.linear).norm() < 1e-9);
    CHECK((back.angular - twist.angular).norm() < 1e-12);
  }
}

TEST_CASE("orthonormalising mends a drifted rotation and leaves the translation") {
  Pose pose = pose_from_xyz_rpy({7, 8, 9}, 0.5, 0.6, 0.7);
  const Pose good = pose;
  pose.linear() *= 1.001;
  CHECK(orthonormalized(pose).isApprox(good, 1e-9));
}
