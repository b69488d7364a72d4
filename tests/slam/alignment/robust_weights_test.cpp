// Ceres first: doctest's CHECK would otherwise be glog's.
#include "alignment/robust_weights.h"

#include "testing.h"

using namespace hqslam::slam;

namespace {

/// A point so far above a floor.
PlaneConstraint at_height(double height_m, double weight = 1.0) {
  return {{1.0, 2.0, height_m}, {0.0, 0.0, 1.0}, 0.0, weight};
}

}  // namespace

TEST_CASE("sigma is 2 cm and twice the median, weights fall over a scale of three medians") {
  // Distances 0.02, 0.04, 0.12 m and one that is missing: the median is 0.04, the scale 0.12 m.
  std::vector<std::optional<PlaneConstraint>> found = {at_height(0.02), std::nullopt,
                                                       at_height(-0.12, 0.5), at_height(0.04)};
  const double per_sigma = 1.0 / std::hypot(0.02, 0.08);
  weigh_by_noise(found, 0.05, true);
  CHECK(found[0]->weight == doctest::Approx(per_sigma / (1.0 + 1.0 / 36.0)));
  CHECK(!found[1]);
  CHECK(found[2]->weight == doctest::Approx(per_sigma * 0.25));
  CHECK(found[3]->weight == doctest::Approx(per_sigma * 0.9));
}

TEST_CASE("before the pose is near all features of a kind have equal weights") {
  std::vector<std::optional<PlaneConstraint>> found = {at_height(0.02), at_height(0.3),
                                                       at_height(0.04)};
  weigh_by_noise(found, 0.05, false);
  for (const auto& plane : found) {
    CHECK(plane->weight == doctest::Approx(1.0 / std::hypot(0.02, 0.08)));
  }
}

TEST_CASE("the scale of the weights is never smaller than the option") {
  std::vector<std::optional<PlaneConstraint>> found = {at_height(0.0), at_height(0.0),
                                                       at_height(0.05)};
  weigh_by_noise(found, 0.05, true);
  CHECK(found[0]->weight == doctest::Approx(1.0 / 0.02));
  CHECK(found[2]->weight == doctest::Approx(0.5 / 0.02));
}

TEST_CASE("an edge is weighed by its distance from the line, both its planes alike") {
  // 0.03 and 0.04 m from the two planes: 0.05 m from their line.
  const EdgeConstraints edge = {
      {{{0.03, 0.04, 0.0}, {1, 0, 0}, 0.0, 1.0}, {{0.03, 0.04, 0.0}, {0, 1, 0}, 0.0, 1.0}}};
  std::vector<std::optional<EdgeConstraints>> found = {edge};
  weigh_by_noise(found, 0.15, true);
  const double per_sigma = 1.0 / std::hypot(0.02, 0.1);
  CHECK((*found[0])[0].weight == doctest::Approx(0.9 * per_sigma));
  CHECK((*found[0])[1].weight == doctest::Approx(0.9 * per_sigma));
}
