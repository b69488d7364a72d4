#include "loops/place_search.h"

#include "slam/random_unit.h"

using slam::search_place;

namespace {

/// Posts from 0 to 4 m height at irregular places.
std::vector<Eigen::Vector2d> posts(unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<Eigen::Vector2d> result(40);
  for (auto& p : result) p = 25.0 * random_vector(generator).head<2>();
  return result;
}

std::vector<Eigen::Vector3f> points_of(const std::vector<Eigen::Vector2d>& posts_m,
                                       const Pose& T_sensor_place) {
  std::vector<Eigen::Vector3f> result;
  for (const auto& p : posts_m) {
    for (double z_m = 0.0; z_m <= 4.0; z_m += 0.5) {
      result.push_back((T_sensor_place * Eigen::Vector3d(p.x(), p.y(), z_m)).cast<float>());
    }
  }
  return result;
}

}  // namespace

TEST_CASE("a sensor is found to half a metre anywhere within the window, and at one place only") {
  const auto structure = points_of(posts(1), Pose::Identity());
  for (const auto& [x_m, y_m, turn_rad] :
       {std::tuple{0.0, 0.0, 0.0}, {6.9, -7.3, 0.08}, {-3.1, 4.2, -0.1}}) {
    const Pose truth = pose_from_xyz_rpy({x_m, y_m, 0.0}, 0.0, 0.0, 2.0 + turn_rad);
    const auto found = search_place(structure, points_of(posts(1), truth.inverse()), 2.0);
    REQUIRE(found.size() == 2);
    const Pose error = truth.inverse() * found[0].T_place_sensor;
    CHECK(error.translation().norm() < 0.6);
    CHECK(rotation_angle_rad(error) < 0.03);
    CHECK(found[0].share > 0.7);
    CHECK(found[1].share < 0.5 * found[0].share);
    CHECK((found[1].T_place_sensor.translation() - found[0].T_place_sensor.translation()).norm() >=
          3.0);
  }
}

TEST_CASE("in a row of equal posts the second-best place is as good as the best") {
  std::vector<Eigen::Vector2d> row;
  for (int i = -15; i <= 15; ++i) row.emplace_back(5.0 * i, 6.0);
  const auto structure = points_of(row, Pose::Identity());
  const std::vector<Eigen::Vector2d> some(row.begin() + 12, row.begin() + 19);
  const auto found = search_place(structure, points_of(some, Pose::Identity()), 0.0);
  REQUIRE(found.size() == 2);
  CHECK(found[1].share == found[0].share);
}

TEST_CASE("where nothing stands nothing is found") {
  CHECK(search_place({}, points_of(posts(1), Pose::Identity()), 0.0).empty());
  CHECK(search_place(points_of(posts(1), Pose::Identity()), {}, 0.0).empty());
}

TEST_CASE("upright structure has height; ground, however steep, has none") {
  std::vector<Eigen::Vector3f> points_m;
  for (float x_m = -10.0F; x_m <= 10.0F; x_m += 0.25F) {
    for (float y_m = -10.0F; y_m <= 10.0F; y_m += 0.25F) {
      points_m.emplace_back(x_m, y_m, 0.3F * x_m);  // ground that rises by 30 %
    }
  }
  for (float z_m = 1.0F; z_m <= 3.0F; z_m += 0.5F) points_m.emplace_back(3.1F, 2.1F, z_m);
  const auto upright = slam::upright_structure_m(points_m);
  CHECK(upright.size() >= 5);
  CHECK(upright.size() <= 5 + 9);  // the ground beneath the post is in its column
}
