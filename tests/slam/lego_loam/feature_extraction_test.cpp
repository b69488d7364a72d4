#include "feature_extraction.h"

#include "testing.h"

using namespace hqslam::lego_loam;

namespace {

constexpr int kColumns = 70;  // five are left out at either end, ten are in each section

/// One row on a wall, or on the ground, 10 m away.
SegmentedScan row_of_points(bool ground) {
  SegmentedScan scan;
  scan.label.assign(kColumns, 1);
  scan.rows.resize(1);
  for (int column = 0; column < kColumns; ++column) {
    const Eigen::Vector3f point_m(10.0F, 0.1F * static_cast<float>(column), 0.0F);
    scan.rows[0].push_back({point_of(point_m, 0, 0.5), 10.0F, column, ground});
  }
  return scan;
}

std::size_t count(const Features& features, FeatureKind kind) {
  return std::ranges::count(features.kind, kind);
}

}  // namespace

TEST_CASE("a point that stands out is an edge, and its neighbours are not") {
  SegmentedScan scan = row_of_points(false);
  scan.rows[0][30].range_m = 9.9F;  // c = (10 * 0.1 m)^2 = 1 m^2; its neighbours' 0.01 m^2
  const Features features = extract_features(scan, kColumns);
  CHECK(features.kind[30] == FeatureKind::kSharp);
  CHECK(features.sharp.size() == 1);
  CHECK(features.less_sharp.size() == 1);
  CHECK(features.flat.empty());
  CHECK(count(features, FeatureKind::kLessFlat) == 59);
  CHECK(features.less_flat_ground.empty());
}

TEST_CASE("the ground has no edges but up to four flat points a section, five columns apart") {
  SegmentedScan scan = row_of_points(true);
  scan.rows[0][30].range_m = 9.9F;
  const Features features = extract_features(scan, kColumns);
  CHECK(features.sharp.empty());
  CHECK(features.flat.size() == 10);  // columns 5, 11, 17, ... but for that which stands out
  CHECK(features.less_flat_cluster.empty());
}

TEST_CASE("of two surfaces one behind the other the farther gives no edge") {
  SegmentedScan scan = row_of_points(false);
  for (int column = 40; column < kColumns; ++column) scan.rows[0][column].range_m = 15.0F;
  const Features features = extract_features(scan, kColumns);
  CHECK(features.kind[39] == FeatureKind::kSharp);
  for (int column = 40; column <= 45; ++column) {
    CHECK(features.kind[column] == FeatureKind::kLessFlat);
  }
}
