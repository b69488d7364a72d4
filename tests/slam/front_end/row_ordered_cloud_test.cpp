#include "front_end/row_ordered_cloud.h"

#include "testing.h"

using namespace hqslam::slam;

namespace {

struct FeaturesAndPoints {
  std::vector<FeaturePoint> features;
  std::vector<Eigen::Vector3f> points_m;
};

/// Random points in rows 0..9; row 4 is empty.
FeaturesAndPoints random_rows(int count, unsigned seed) {
  std::mt19937 generator(seed);
  const auto random = [&] { return static_cast<float>(generator() % 20001) / 1000.0F - 10.0F; };
  FeaturesAndPoints result;
  for (int row = 0; row < 10; ++row) {
    for (int i = 0; row != 4 && i < count; ++i) {
      const Eigen::Vector3f p(random(), random(), 0.1F * random());
      result.features.push_back({p, 0.0F, row});
      result.points_m.push_back(p);
    }
  }
  return result;
}

/// FeaturesAndPoints as a sensor sees them: each row at an elevation of its own, 12 degrees up to
/// 15 down.
FeaturesAndPoints rings(int count, unsigned seed) {
  FeaturesAndPoints result = random_rows(count, seed);
  for (std::size_t i = 0; i < result.points_m.size(); ++i) {
    Eigen::Vector3f& p = result.points_m[i];
    const float elevation_rad = 0.2F - 0.05F * static_cast<float>(result.features[i].row);
    p.z() = p.head<2>().norm() * std::tan(elevation_rad);
    result.features[i].point_m = p;
  }
  return result;
}

float slow_nearest_m2(const FeaturesAndPoints& points, const Eigen::Vector3f& query_m,
                      const auto& accept) {
  float best_m2 = 25.0F;
  for (std::size_t i = 0; i < points.points_m.size(); ++i) {
    if (accept(points.features[i].row, points.points_m[i])) {
      best_m2 = std::min(best_m2, (points.points_m[i] - query_m).squaredNorm());
    }
  }
  return best_m2;
}

void compare_with_search_through_all(const FeaturesAndPoints& points,
                                     const FeaturesAndPoints& queries) {
  const RowOrderedCloud cloud(points.features, points.points_m);
  for (const Eigen::Vector3f& query_m : queries.points_m) {
    const RowQuery query(query_m);
    const auto first = cloud.nearest(query, 5.0).value();
    const Eigen::Vector3f first_m = cloud.point_m(first);
    CHECK((first_m - query_m).squaredNorm() ==
          doctest::Approx(slow_nearest_m2(points, query_m, [](int, const auto&) { return true; })));
    const auto found = std::find(points.points_m.begin(), points.points_m.end(), first_m);
    const int row = points.features[found - points.points_m.begin()].row;
    const auto second = cloud.nearest_in_row_of(first, query, 5.0);
    const float second_m2 = slow_nearest_m2(
        points, query_m, [&](int r, const auto& p) { return r == row && p != first_m; });
    if (second_m2 < 25.0F) REQUIRE(second);
    if (second) CHECK((cloud.point_m(*second) - query_m).squaredNorm() == second_m2);
    const auto third = cloud.nearest_near_row_of(first, query, 5.0);
    const float third_m2 = slow_nearest_m2(
        points, query_m, [&](int r, const auto&) { return r != row && std::abs(r - row) <= 2; });
    if (third_m2 < 25.0F) REQUIRE(third);
    if (third) CHECK((cloud.point_m(*third) - query_m).squaredNorm() == third_m2);
  }
}

}  // namespace

TEST_CASE("nearest, in the row and near the row agree with a search through all") {
  compare_with_search_through_all(random_rows(40, 1), random_rows(30, 2));
  compare_with_search_through_all(rings(40, 1), rings(30, 2));
  compare_with_search_through_all(rings(40, 1), random_rows(30, 3));
}

TEST_CASE("an empty cloud and a query that is not finite find nothing") {
  CHECK(!RowOrderedCloud({}, {}).nearest(RowQuery({0, 0, 0}), 5.0));
  CHECK(!RowOrderedCloud().nearest(RowQuery({0, 0, 0}), 5.0));
  const FeaturesAndPoints points = random_rows(3, 1);
  const RowOrderedCloud cloud(points.features, points.points_m);
  CHECK(!cloud.nearest(RowQuery({std::nanf(""), 0, 0}), 5.0));
  CHECK(!cloud.nearest(RowQuery({100, 0, 0}), 5.0));
}

TEST_CASE("points that are not finite are left out, and the others are found") {
  FeaturesAndPoints points = rings(50, 7);
  const FeaturesAndPoints sound = points;
  const Eigen::Vector3f nowhere_m = Eigen::Vector3f::Constant(std::nanf(""));
  for (int row = 9; row >= 0; --row) {
    points.features.push_back({nowhere_m, 0.0F, row});
    points.points_m.push_back(row % 2 == 0 ? nowhere_m : Eigen::Vector3f(HUGE_VALF, 0.0F, 0.0F));
  }
  const RowOrderedCloud cloud(points.features, points.points_m);
  CHECK(cloud.size() == sound.points_m.size());
  for (const Eigen::Vector3f& point_m : sound.points_m) {
    CHECK(cloud.point_m(cloud.nearest(RowQuery(point_m), 5.0).value()) == point_m);
  }
}
