#include "registration.h"

#include "testing.h"

using namespace hqslam::lego_loam;

TEST_CASE("pose and parameters are two forms of one motion, of which a share can be taken") {
  const PoseParameters p{{0.3, 0.1, -0.2}, {1.0, 2.0, 0.7}};
  const PoseParameters again = parameters_of(pose_of(p));
  CHECK(again.out_of_plane.isApprox(p.out_of_plane));
  CHECK(again.in_plane.isApprox(p.in_plane));
  CHECK(pose_of(p, 0.0).isApprox(Pose::Identity()));
}

TEST_CASE("a line is two planes, and far correspondences weigh less or are left out") {
  Constraints constraints;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  add_line({{4.0, 0.4, 7.0}, {4.0, 0.0, 0.0}, {}}, up, Pose::Identity(), 1.8, constraints);
  REQUIRE(constraints.size() == kPerLine);
  for (const Constraint& constraint : constraints) {
    CHECK(constraint.weight == doctest::Approx(0.28));
    CHECK(constraint.n.dot(up) == doctest::Approx(0.0));
  }
  add_line({{4.0, 0.6, 7.0}, {4.0, 0.0, 0.0}, {}}, up, Pose::Identity(), 1.8, constraints);
  add_line({{4.0, 0.0, 7.0}, {4.0, 0.0, 0.0}, {}}, {0, 0, 0}, Pose::Identity(), 1.8, constraints);
  CHECK(constraints.size() == kPerLine);
  add_plane({{4.0, 0.0, 0.5}, {0.0, 0.0, 0.0}, up}, Pose::Identity(), 1.8, constraints);
  CHECK(constraints.back().weight == doctest::Approx(1.0 - 1.8 * 0.5 / std::pow(16.25, 0.25)));
}
