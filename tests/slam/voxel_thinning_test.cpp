#include "voxel_thinning.h"

#include <doctest/doctest.h>

using hqslam::slam::FeaturePoint;

TEST_CASE("points of one voxel become their mean, in position and time") {
  const std::vector<FeaturePoint> points = {
      {{0.01F, 0.01F, 0.01F}, 0.02F, 3}, {{0.03F, 0.05F, 0.01F}, 0.04F, 3}, {{1, 1, 1}, 0.0F, 3}};
  const auto thinned = hqslam::slam::thin(points, 0.2);
  REQUIRE(thinned.size() == 2);
  CHECK((thinned[0].point_m - Eigen::Vector3f(0.02F, 0.03F, 0.01F)).norm() < 1e-6F);
  CHECK(thinned[0].time_offset_s == doctest::Approx(0.03));
  CHECK(thinned[0].row == 3);
  CHECK(thinned[1].point_m == Eigen::Vector3f(1, 1, 1));
}

TEST_CASE("thinning nothing gives nothing") { CHECK(hqslam::slam::thin({}, 0.2).empty()); }
