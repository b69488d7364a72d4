#include "hqslam/core/trajectory.h"

#include <doctest/doctest.h>

using namespace hqslam;

namespace {

Trajectory a_corner() {
  return {{0.0, pose_from_xyz_rpy({1, 2, 3}, 0.0, 0.0, 1.5707963267948966)},
          {1.0, pose_from_xyz_rpy({1, 5, 3}, 0.0, 0.0, 0.0)},
          {2.0, pose_from_xyz_rpy({5, 5, 3}, 0.1, 0.2, 0.3)}};
}

}  // namespace

TEST_CASE("the path length is the sum of the straight distances between poses") {
  CHECK(path_length_m(a_corner()) == doctest::Approx(7.0));
  CHECK(path_length_m({}) == 0.0);
  CHECK(path_length_m({a_corner().front()}) == 0.0);
}

TEST_CASE("a trajectory relative to its first pose starts at the origin and keeps all motions") {
  const Trajectory corner = a_corner();
  const Trajectory relative = relative_to_first(corner);
  REQUIRE(relative.size() == 3);
  CHECK(relative[0].T_map_sensor.matrix() == Eigen::Matrix4d::Identity());
  // The first pose looks along y, so three metres along y are three metres ahead of it.
  CHECK((relative[1].T_map_sensor.translation() - Eigen::Vector3d(3, 0, 0)).norm() < 1e-12);
  for (std::size_t i = 1; i < 3; ++i) {
    CHECK(relative[i].stamp_s == corner[i].stamp_s);
    const Pose motion = corner[i - 1].T_map_sensor.inverse() * corner[i].T_map_sensor;
    const Pose same = relative[i - 1].T_map_sensor.inverse() * relative[i].T_map_sensor;
    CHECK(motion.isApprox(same, 1e-12));
  }
  CHECK(relative_to_first({}).empty());
}
