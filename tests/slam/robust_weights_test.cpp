// Ceres first: doctest's CHECK would otherwise be glog's.
#include "robust_weights.h"

#include <doctest/doctest.h>

using namespace hqslam;
using slam::EdgeConstraints;
using slam::PlaneConstraint;
using slam::trust_near;

namespace {

/// A point so far above a floor.
PlaneConstraint at_height(double height_m, double weight = 1.0) {
  return {{1.0, 2.0, height_m}, {0.0, 0.0, 1.0}, 0.0, weight};
}

}  // namespace

TEST_CASE("weights fall with the distance over a scale of three medians") {
  // Distances 0.02, 0.04, 0.12 m and one that is missing: the median is 0.04, the scale 0.12 m.
  std::vector<std::optional<PlaneConstraint>> found = {at_height(0.02), std::nullopt,
                                                       at_height(-0.12, 0.5), at_height(0.04)};
  trust_near(found, 0.05);
  CHECK(found[0]->weight == doctest::Approx(1.0 / (1.0 + 1.0 / 36.0)));
  CHECK(!found[1]);
  CHECK(found[2]->weight == doctest::Approx(0.25));
  CHECK(found[3]->weight == doctest::Approx(0.9));
}

TEST_CASE("the scale of the weights is never smaller than asked for") {
  std::vector<std::optional<PlaneConstraint>> found = {at_height(0.0), at_height(0.0),
                                                       at_height(0.05)};
  trust_near(found, 0.05);
  CHECK(found[0]->weight == 1.0);
  CHECK(found[2]->weight == doctest::Approx(0.5));
}

TEST_CASE("an edge is weighed by its distance from the line, both its planes alike") {
  // 0.03 and 0.04 m from the two planes: 0.05 m from their line.
  const EdgeConstraints edge = {
      {{{0.03, 0.04, 0.0}, {1, 0, 0}, 0.0, 1.0}, {{0.03, 0.04, 0.0}, {0, 1, 0}, 0.0, 1.0}}};
  std::vector<std::optional<EdgeConstraints>> found = {edge};
  trust_near(found, 0.15);
  CHECK((*found[0])[0].weight == doctest::Approx(0.9));
  CHECK((*found[0])[1].weight == doctest::Approx(0.9));
}

TEST_CASE("no features, no weights") {
  std::vector<std::optional<PlaneConstraint>> none = {std::nullopt, std::nullopt};
  trust_near(none, 0.05);
  CHECK(!none[0]);
}
