#include "map/feature_map.h"

#include "slam/random_unit.h"

using hqslam::Pose;
using namespace hqslam::slam;

namespace {

std::vector<Eigen::Vector3f> random_points_m(int count, float extent_m, unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<Eigen::Vector3f> points(count);
  const Eigen::Vector3d extents_m(extent_m, extent_m, 0.2 * extent_m);
  for (auto& p : points) {
    p = random_vector(generator).cwiseProduct(extents_m).cast<float>();
  }
  return points;
}

/// What nearest() finds at these places against a search through all points.
void check_neighbours(const FeatureMap& map, const std::vector<Eigen::Vector3f>& queries_m) {
  const auto all = map.points_m();
  CHECK(all.size() == map.size());
  for (const auto& query : queries_m) {
    std::vector<float> distances_m2;
    for (const auto& p : all) {
      const float d2 = (p - query).squaredNorm();
      if (d2 < 1.0F) distances_m2.push_back(d2);
    }
    std::ranges::sort(distances_m2);
    const float sixth_m2 =
        distances_m2.size() > Neighbours::kWanted ? distances_m2[Neighbours::kWanted] : 1.0F;
    distances_m2.resize(std::min<std::size_t>(distances_m2.size(), Neighbours::kWanted));
    const Neighbours found = map.nearest(query);
    REQUIRE(found.count == static_cast<int>(distances_m2.size()));
    CHECK(found.sixth_squared_m2 == sixth_m2);
    for (int i = 0; i < found.count; ++i) {
      CHECK(found.squared_distance_m2[i] == distances_m2[i]);
      CHECK((found.points_m[i] - query).squaredNorm() == distances_m2[i]);
    }
  }
}

}  // namespace

TEST_CASE("neighbours are those of a search through all points of the map, also after many left") {
  FeatureMap map(0.4, 1.0);
  map.insert(random_points_m(20000, 15.0F, 1));
  check_neighbours(map, random_points_m(500, 16.0F, 2));
  FeatureMap emptied(0.4, 1.0);
  emptied.insert(random_points_m(8000, 12.0F, 6), 0);
  emptied.insert(random_points_m(1500, 4.0F, 7), 1);
  CHECK(emptied.take_not_observed_since(1).size() > 1000);
  emptied.insert(random_points_m(500, 12.0F, 9), 2);
  check_neighbours(emptied, random_points_m(200, 13.0F, 8));
}

TEST_CASE("points kept by a search give neighbours of places beside, as far as they are known") {
  FeatureMap map(0.4, 1.0);
  map.insert(random_points_m(20000, 15.0F, 3));
  int known = 0;
  for (const auto& place_m : random_points_m(500, 15.0F, 4)) {
    const Eigen::Vector3f beside_m = place_m + Eigen::Vector3f(0.05F, -0.1F, 0.02F);
    const Neighbours found = map.nearby(place_m, 0.8F).nearest(beside_m);
    const Neighbours anew = map.nearest(beside_m);
    REQUIRE(found.count <= anew.count);
    for (int i = 0; i < found.count; ++i) CHECK(found.points_m[i] == anew.points_m[i]);
    if (found.count < anew.count) {
      CHECK(anew.squared_distance_m2[found.count] >= found.sixth_squared_m2);
    }
    known += found.count == anew.count ? 1 : 0;
  }
  CHECK(known > 100);
}

TEST_CASE("a voxel keeps one point, the mean of those that fell in it first") {
  FeatureMap map(0.4, 1.0);
  map.insert({{0.1F, 0.1F, 0.1F}, {0.3F, 0.1F, 0.1F}, {0.5F, 0.1F, 0.1F}});
  REQUIRE(map.size() == 2);
  CHECK((map.points_m()[0] - Eigen::Vector3f(0.2F, 0.1F, 0.1F)).norm() < 1e-6F);
  FeatureMap full(0.4, 1.0);
  full.insert(std::vector<Eigen::Vector3f>(100, {0.1F, 0.1F, 0.1F}));
  full.insert(std::vector<Eigen::Vector3f>(1000, {0.3F, 0.3F, 0.3F}));
  CHECK((full.points_m()[0] - Eigen::Vector3f(0.1F, 0.1F, 0.1F)).norm() < 1e-6F);
}

TEST_CASE("negative coordinates and cube borders are like any other place") {
  FeatureMap map(0.2, 1.0);
  map.insert({{-0.01F, -0.01F, -0.01F}, {0.01F, 0.01F, 0.01F}});
  CHECK(map.size() == 2);
  CHECK(map.nearest({0, 0, 0}).count == 2);
}

TEST_CASE("points that are not finite or beyond every map are left out, and queries find nothing") {
  FeatureMap map(0.4, 1.0);
  const float infinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  map.insert({{nan, 0, 0}, {0, infinity, 0}, {1e9F, 0, 0}});
  CHECK(map.size() == 0);
  map.insert({{1, 1, 1}});
  CHECK(map.nearest({nan, 1, 1}).count == 0);
  CHECK(map.nearest({infinity, 1, 1}).count == 0);
  CHECK(map.nearest({1, 1, 1}).count == 1);
}

TEST_CASE("points near a place are those within the radius, and can be taken out") {
  FeatureMap map(0.4, 1.0);
  map.insert(random_points_m(3000, 30.0F, 3));
  const Eigen::Vector3d centre_m(-4.0, 7.0, 0.5);
  std::size_t expected = 0;
  for (const auto& p : map.points_m()) {
    const Eigen::Vector3d offset_m = p.cast<double>() - centre_m;
    expected += offset_m.head<2>().norm() <= 9.0 && std::abs(offset_m.z()) <= 4.5;
  }
  CHECK(expected > 50);
  const Surroundings place{centre_m.cast<float>(), 9.0F};
  CHECK(map.points_near_m(place).size() == expected);
  const std::size_t all = map.size();
  CHECK(map.take_near(place).size() == expected);
  CHECK(map.size() == all - expected);
  CHECK(map.points_near_m(place).empty());
}

TEST_CASE("a corrected map moves every point with its keyframe") {
  // Keyframe 1 has the same corner as keyframe 0, but 5 m too far along x.
  FeatureMap map(0.4, 1.0);
  map.insert({{0.1F, 0.1F, 0.1F}, {1.1F, 0.1F, 0.1F}}, 0);
  map.insert({{5.3F, 0.1F, 0.1F}, {7.1F, 0.1F, 0.1F}}, 1);
  map.correct({Pose::Identity(), Pose(Eigen::Translation3d(-5.0, 0.0, 0.0))});
  REQUIRE(map.size() == 3);
  const auto points = map.points_m();
  CHECK((points[1] - Eigen::Vector3f(1.1F, 0.1F, 0.1F)).norm() < 1e-5F);
  CHECK((points[0] - Eigen::Vector3f(0.2F, 0.1F, 0.1F)).norm() < 1e-5F);
  CHECK((points[2] - Eigen::Vector3f(2.1F, 0.1F, 0.1F)).norm() < 1e-5F);
  // A search finds what moved, nothing is left; where two met, the older keyframe is kept.
  CHECK(map.nearest({2.1F, 0.1F, 0.1F}).squared_distance_m2[0] < 1e-6F);
  CHECK(map.nearest({7.1F, 0.1F, 0.1F}).count == 0);
  CHECK(map.take_near({{0, 0, 0}, 0.5F}).front().keyframe == 0);
}

TEST_CASE("a voxel keeps the mean intensity of its points, merged and moved ones included") {
  FeatureMap map(0.4, 1.0);
  map.insert({{0.1F, 0.1F, 0.1F}, {0.3F, 0.1F, 0.1F}, {0.5F, 0.1F, 0.1F}}, 0, {10.0F, 40.0F, 7.0F});
  CHECK(map.intensity() == std::vector<float>{25.0F, 7.0F});
  // A point of two and one of one, when the second moves into the voxel of the first.
  map.insert({{1.7F, 0.1F, 0.1F}}, 1, {100.0F});
  map.correct({Pose::Identity(), Pose(Eigen::Translation3d(-1.5, 0.0, 0.0))});
  CHECK(map.intensity() == std::vector<float>{50.0F, 7.0F});
  // Unknown intensities do not count; the first known one is taken.
  map.insert({{0.2F, 0.1F, 0.1F}, {3.1F, 0.1F, 0.1F}}, 0);
  REQUIRE(map.intensity().size() == 3);
  CHECK(map.intensity()[0] == 50.0F);
  CHECK(std::isnan(map.intensity()[2]));
  map.insert({{3.1F, 0.1F, 0.1F}}, 0, {3.0F});
  CHECK(map.intensity()[2] == 3.0F);
}

TEST_CASE("a correction by the identity leaves the same bytes") {
  FeatureMap map(0.4, 1.0);
  map.insert(random_points_m(5000, 10.0F, 4), 0);
  map.insert(random_points_m(5000, 10.0F, 5), 1);
  const auto before = map.points_m();
  map.correct({Pose::Identity(), Pose::Identity()});
  CHECK(map.points_m() == before);
}

TEST_CASE("points not observed recently are taken out; later ones there are points of their own") {
  FeatureMap map(0.4, 1.0);
  map.insert({{0.1F, 0.1F, 0.1F}, {1.1F, 0.1F, 0.1F}}, 0);
  map.insert({{1.15F, 0.1F, 0.1F}}, 5);
  const std::vector<MapPoint> taken = map.take_not_observed_since(5);
  REQUIRE(taken.size() == 1);
  CHECK(taken[0].mean_m == Eigen::Vector3f(0.1F, 0.1F, 0.1F));
  // Keyframe 5 observed the second point again: it stays.
  CHECK(map.nearest({0.1F, 0.1F, 0.1F}).count == 0);
  CHECK(map.nearest({1.1F, 0.1F, 0.1F}).count == 1);
  map.insert({{0.3F, 0.1F, 0.1F}}, 6);
  CHECK(map.nearest({0.1F, 0.1F, 0.1F}).points_m[0] == Eigen::Vector3f(0.3F, 0.1F, 0.1F));
  // Put in again it is merged, and still of the keyframe of old.
  map.insert(taken);
  REQUIRE(map.size() == 2);
  const Eigen::Vector3f merged_m = map.nearest({0.1F, 0.1F, 0.1F}).points_m[0];
  CHECK((merged_m - Eigen::Vector3f(0.2F, 0.1F, 0.1F)).norm() < 1e-6F);
  CHECK(map.take_near({{0, 0, 0}, 0.5F}).front().keyframe == 0);
}

TEST_CASE("a region that is far away, or larger than the map, is searched as any other") {
  FeatureMap map(0.4, 1.0);
  map.insert({{0.0F, 0.0F, 0.0F}, {5.0F, 0.0F, 0.0F}, {90.0F, -70.0F, 3.0F}});
  for (const float far_m : {1e7F, 1e20F, std::numeric_limits<float>::infinity()}) {
    CHECK(map.points_near_m({{far_m, 0.0F, -far_m}, 45.0F}).empty());
    // In the order in which the cubes of a small place are met: by x, y and z.
    CHECK(map.points_near_m({{0.0F, 0.0F, 0.0F}, far_m}).size() == 3);
  }
}

TEST_CASE("a point taken out and reinserted thousands of times stays in its voxel") {
  FeatureMap map(0.4, 1.0);
  std::vector<MapPoint> point;
  for (int lap = 0; lap < 4000; ++lap) {
    const Eigen::Vector3f seen_m(lap % 2 == 0 ? 0.1F : 0.3F, 0.1F, 0.1F);
    map.insert(std::vector<Eigen::Vector3f>(19, seen_m));
    map.insert(point);
    point = map.take_not_observed_since(1);
    REQUIRE(point.size() == 1);
    REQUIRE((point[0].mean_m - Eigen::Vector3f(0.2F, 0.1F, 0.1F)).norm() < 0.11F);
  }
}
