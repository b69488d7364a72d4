#include "map/recent_features.h"

#include "slam/poses.h"

namespace {

slam::MapFeatures one_edge_at(float x_m) {
  slam::MapFeatures features;
  features.edges = {{{x_m, 0.0F, 0.0F}, 0.0F, 0}};
  return features;
}

std::vector<float> sorted_x_m(const slam::MapFeatures& features) {
  std::vector<float> result;
  for (const auto& edge : features.edges) result.push_back(edge.point_m.x());
  std::ranges::sort(result);
  return result;
}

}  // namespace

TEST_CASE("features of the last scans come together in the frame of the last one") {
  slam::RecentFeatures recent(2);
  recent.add(one_edge_at(1.0F), at_x(0.0), {});  // dropped
  recent.add(one_edge_at(2.0F), at_x(10.0), {});
  recent.add(one_edge_at(3.0F), at_x(14.0), {});
  CHECK(sorted_x_m(recent.about_last()) == std::vector<float>{-2.0F, 3.0F});
  // A correction of the map does not change the features.
  recent.correct(pose_from_xyz_rpy({5.0, -3.0, 1.0}, 0.0, 0.0, 0.5));
  CHECK(recent.about_last().edges.size() == 2);
  CHECK(sorted_x_m(recent.about_last())[0] == doctest::Approx(-2.0));
}

TEST_CASE("points far from the last scan are left out, and many points are thinned") {
  slam::RecentFeatures recent(2);
  slam::MapFeatures features = one_edge_at(36.0F);
  recent.add(features, at_x(0.0), {});
  CHECK(recent.about_last().edges.empty());
  for (int i = 0; i < 1000; ++i) {
    const auto column = static_cast<float>(i % 40);
    const auto row = static_cast<float>(i / 40);
    features.edges.push_back({{0.02F * column, 0.5F * row, 0.4F * column}, 0.0F, 0});
  }
  recent.add(features, at_x(0.0), {});
  CHECK(recent.about_last().edges.size() == 800);
}

TEST_CASE("features measured during the motion are put where they belong") {
  slam::RecentFeatures recent(2);
  slam::MapFeatures features;
  features.surfaces_to_register = {{{4.0F, 0.0F, 0.0F}, 0.05F, 0}};
  recent.add(features, Pose::Identity(), {{{10.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}});
  CHECK(recent.about_last().surfaces_to_register[0].point_m.x() == doctest::Approx(4.5));
}
