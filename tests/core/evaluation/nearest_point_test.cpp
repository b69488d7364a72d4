#include "nearest_point.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>

using hqslam::NearestPoint;

namespace {

float slowly_found_m2(const std::vector<Eigen::Vector3f>& points_m,
                      const Eigen::Vector3f& query_m) {
  float nearest_m2 = std::numeric_limits<float>::infinity();
  for (const Eigen::Vector3f& p : points_m) {
    nearest_m2 = std::min(nearest_m2, (p - query_m).squaredNorm());
  }
  return nearest_m2;
}

/// Points in `cells` places per axis: few cells mean many equal points.
std::vector<Eigen::Vector3f> points_on_a_grid(int count, unsigned cells, std::mt19937& generator) {
  const auto coordinate = [&] { return 0.37F * static_cast<float>(generator() % cells); };
  std::vector<Eigen::Vector3f> points_m;
  for (int i = 0; i < count; ++i) {
    const float x = coordinate();
    const float y = coordinate();
    points_m.emplace_back(x, y, coordinate());
  }
  return points_m;
}

}  // namespace

TEST_CASE("the nearest point is the one that a search of all points finds") {
  std::mt19937 generator(7);
  for (const int count : {1, 2, 12, 13, 14, 100, 2000}) {
    for (const unsigned cells : {1U, 3U, 100000U}) {
      CAPTURE(count);
      CAPTURE(cells);
      const auto points_m = points_on_a_grid(count, cells, generator);
      const NearestPoint nearest(points_m);
      for (const Eigen::Vector3f& query_m : points_on_a_grid(50, 2 * cells, generator)) {
        CHECK(nearest.squared_distance_m2(query_m) == slowly_found_m2(points_m, query_m));
      }
      CHECK(nearest.squared_distance_m2(points_m.front()) == 0.0);
      const Eigen::Vector3f far_m(-1e5F, 3e4F, 1.0F);
      CHECK(nearest.squared_distance_m2(far_m) == slowly_found_m2(points_m, far_m));
    }
  }
}
