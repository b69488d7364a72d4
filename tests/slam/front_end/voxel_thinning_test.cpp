#include "front_end/voxel_thinning.h"

#include "slam/random_unit.h"

using namespace hqslam::slam;

namespace {

/// The corner of a point's voxel of 0.5 m.
Eigen::Array3f first_of_voxel_m(const FeaturePoint& point) {
  return 0.5F * (2.0F * point.point_m.array()).floor();
}

}  // namespace

TEST_CASE("points of one voxel become their mean: place, time, slope and what is known of light") {
  const std::vector<FeaturePoint> points = {{{0.01F, 0.01F, 0.01F}, 0.02F, 3, {1, 0, 0}, 10.0F},
                                            {{0.03F, 0.05F, 0.01F}, 0.04F, 3, {0, 0, 1}},
                                            {{0.05F, 0.06F, 0.01F}, 0.06F, 3, {0, 0, 0}, 40.0F},
                                            {{1, 1, 1}, 0.0F, 3}};
  const auto thinned = hqslam::slam::thin(points, 0.2);
  REQUIRE(thinned.size() == 2);
  CHECK((thinned[0].point_m - Eigen::Vector3f(0.03F, 0.04F, 0.01F)).norm() < 1e-6F);
  CHECK(thinned[0].time_offset_s == doctest::Approx(0.04));
  CHECK(thinned[0].row == 3);
  const float half = std::sqrt(0.5F);
  CHECK((thinned[0].slope - Eigen::Vector3f(half, 0.0F, half)).norm() < 1e-6F);
  CHECK(thinned[0].intensity == 25.0F);
  CHECK(thinned[1].point_m == Eigen::Vector3f(1, 1, 1));
  CHECK(thinned[1].slope == Eigen::Vector3f::Zero());
  CHECK(std::isnan(thinned[1].intensity));
}

TEST_CASE("there is one point per voxel, in the order of their first points") {
  // 10 points in each of some voxels of 0.5 m within 2 km, one of all voxels after the other.
  std::vector<FeaturePoint> points;
  std::mt19937 generator(2);
  std::vector<FeaturePoint> places(500);
  for (FeaturePoint& place : places) {
    place.point_m = (1000.0 * random_vector(generator)).cast<float>();
  }
  for (int i = 0; i < 10; ++i) {
    for (const FeaturePoint& place : places) {
      points.push_back({first_of_voxel_m(place) + 0.01F + 0.04F * static_cast<float>(i)});
    }
  }
  std::set<std::tuple<float, float, float>> seen;
  std::vector<Eigen::Array3f> expected_m;
  for (const FeaturePoint& place : places) {
    const Eigen::Array3f first_m = first_of_voxel_m(place);
    if (seen.emplace(first_m.x(), first_m.y(), first_m.z()).second) expected_m.push_back(first_m);
  }
  const std::vector<FeaturePoint> thinned = thin(points, 0.5);
  REQUIRE(thinned.size() == expected_m.size());
  for (std::size_t i = 0; i < thinned.size(); ++i) {
    CHECK((first_of_voxel_m(thinned[i]) == expected_m[i]).all());
  }
}

TEST_CASE("points that are not finite, or a million voxels away, are left out") {
  const std::vector<FeaturePoint> points = {{{1.0F, 2.0F, 3.0F}, 0.0F, 0},
                                            {{std::nanf(""), 0.0F, 0.0F}, 0.0F, 0},
                                            {{0.0F, 2.1e5F, 0.0F}, 0.0F, 0},
                                            {{0.0F, 0.0F, -3e38F}, 0.0F, 0}};
  const std::vector<FeaturePoint> thinned = thin(points, 0.2);
  REQUIRE(thinned.size() == 1);
  CHECK(thinned[0].point_m == points[0].point_m);
}
