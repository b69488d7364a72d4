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
