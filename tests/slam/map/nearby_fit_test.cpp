#include "map/nearby_fit.h"

#include "map/map_matching.h"
#include "testing.h"

using namespace hqslam::slam;

namespace {

Eigen::Vector3f random_point(std::mt19937& generator, float half_side_m) {
  std::uniform_real_distribution<float> coordinate(-half_side_m, half_side_m);
  return {coordinate(generator), coordinate(generator), 0.1F * coordinate(generator)};
}

FeatureMap random_map(std::mt19937& generator) {
  FeatureMap map(0.4, 1.0);
  for (int i = 0; i < 3000; ++i) map.insert({random_point(generator, 8.0F)});
  return map;
}

/// A fit that is different for any other five points.
std::optional<MapPlane> mean_of(const Neighbours& neighbours) {
  MapPlane result{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (const auto& point_m : neighbours.points_m) result.point_m += point_m.cast<double>();
  return result;
}

}  // namespace

TEST_CASE("the stored fit of a moving feature is that of a new search") {
  std::mt19937 generator(1);
  const FeatureMap map = random_map(generator);
  int fits = 0;
  int searches = 0;
  const auto counted = [&](const Neighbours& neighbours) {
    ++searches;
    return mean_of(neighbours);
  };
  for (int feature = 0; feature < 300; ++feature) {
    NearbyFit<MapPlane> nearby;
    Eigen::Vector3f query_m = random_point(generator, 9.0F);
    float step_m = 0.1F;
    for (const double reach_m : {1.0, 1.0, 0.6, 0.6, 0.6, 1.0}) {
      const Neighbours anew = map.nearest(query_m);
      const auto found = nearby.at(map, query_m, reach_m, counted);
      const auto reach_m2 = static_cast<float>(reach_m * reach_m);
      REQUIRE(found.has_value() ==
              (anew.count == Neighbours::kWanted && anew.squared_distance_m2.back() <= reach_m2));
      if (found) {
        ++fits;
        CHECK((found->point_m - mean_of(anew)->point_m).norm() < 1e-9);
      }
      query_m += step_m * random_point(generator, 1.0F).normalized();
      step_m *= 0.3F;
    }
  }
  CHECK(fits > 500);
  CHECK(searches < fits);
}

TEST_CASE("a fit of the nearest point alone is stored likewise") {
  std::mt19937 generator(3);
  const FeatureMap map = random_map(generator);
  const auto first = [](const Neighbours& near) { return std::optional(near.points_m[0]); };
  int found = 0;
  for (int feature = 0; feature < 300; ++feature) {
    NearbyFit<Eigen::Vector3f, 1> nearby;
    Eigen::Vector3f query_m = random_point(generator, 9.0F);
    for (const float step_m : {0.1F, 0.03F, 0.01F, 0.003F}) {
      const Neighbours anew = map.nearest(query_m);
      const auto remembered = nearby.at(map, query_m, 0.6, first);
      REQUIRE(remembered.has_value() == (anew.count > 0 && anew.squared_distance_m2[0] <= 0.36F));
      if (remembered) {
        ++found;
        CHECK(*remembered == anew.points_m[0]);
      }
      query_m += step_m * random_point(generator, 1.0F).normalized();
    }
  }
  CHECK(found > 500);
}
