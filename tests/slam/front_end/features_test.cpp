#include "front_end/features.h"

#include "slam/village.h"

namespace {

/// One row of a sensor that looks straight ahead, all returns of one cluster.
struct OneRow {
  SensorModel sensor;
  OrganizedCloud cloud;
  slam::Segmentation segmentation;

  explicit OneRow(const std::vector<float>& range_m) {
    sensor = beams_at({0.0}, static_cast<int>(range_m.size()));
    RangeImage image(1, sensor.columns);
    image.range_m = range_m;
    cloud = unproject(image, sensor, CaptureTime::kMotionCorrected);
    for (const float range : range_m) {
      segmentation.pixel_class.push_back(range > 0.0F ? slam::PixelClass::kObject
                                                      : slam::PixelClass::kNoReturn);
    }
  }
  slam::Features features() const { return slam::extract_features(cloud, segmentation); }
};

slam::Features yard_features(const SensorModel& sensor, const Yard& yard) {
  return scan_features(yard.scan(sensor, yard_pose(0, 0, 0)), sensor);
}

}  // namespace

TEST_CASE("the slope of the ground is in the ground, across the row, that of a wall upwards") {
  const SensorModel sensor = small_sensor(16, 512);
  const Pose tilted = pose_from_xyz_rpy({0.0, 0.0, 1.7}, 0.05, -0.03, 0.4);
  const Yard floor{.half_length_m = 500.0, .half_width_m = 500.0, .pillars = false};
  const auto features = scan_features(floor.scan(sensor, tilted), sensor);
  const Eigen::Vector3f up = tilted.linear().transpose().col(2).cast<float>();
  CHECK(features.ground.size() > 200);
  for (const auto& point : features.ground) {
    CHECK(point.slope.norm() == doctest::Approx(1.0));
    CHECK(std::abs(point.slope.dot(up)) < 0.02F);
    CHECK(point.slope.head<2>().dot(point.point_m.head<2>().normalized()) > 0.9F);
  }
  for (const auto& point : yard_features(sensor, Yard()).surfaces)
    CHECK(point.slope == Eigen::Vector3f::UnitZ());
}

TEST_CASE("a short run of one row that no other row shows to stand is no feature, a long one is") {
  const SensorModel sensor = small_sensor(16, 512);
  const RangeImage image = flat_image(16, 512, 20.0F);
  slam::Segmentation objects;
  objects.pixel_class.assign(image.range_m.size(), slam::PixelClass::kObject);
  const auto near_features = [&](int run) {
    RangeImage with_run = image;
    for (int column = 100; column < 100 + run; ++column) with_run.at(8, column) = 10.0F;
    const auto cloud = unproject(with_run, sensor, CaptureTime::kMotionCorrected);
    const auto features = slam::extract_features(cloud, objects);
    const auto is_near = [](const auto& point) { return point.point_m.norm() < 15.0F; };
    return std::ranges::count_if(features.surfaces, is_near) +
           std::ranges::count_if(features.edges, is_near);
  };
  CHECK(near_features(40) == 0);
  CHECK(near_features(60) > 10);
}

TEST_CASE("in a scan with computed rows the measured ones have features, the same as alone") {
  const SensorModel sensor = small_sensor(32, 512);
  const OrganizedCloud cloud = Yard().scan(sensor, yard_pose(0, 0, 0));
  const slam::Segmentation segmentation = slam::segment(cloud, sensor);
  const slam::Features of_all = slam::extract_features(cloud, segmentation);
  const auto features = slam::extract_features(cloud, segmentation, RowSelection{3, 4});
  for (const auto kind :
       {&slam::Features::sharp_edges, &slam::Features::edges, &slam::Features::flat_points,
        &slam::Features::ground, &slam::Features::surfaces, &slam::Features::posts}) {
    std::vector<slam::FeaturePoint> expected;
    for (slam::FeaturePoint point : of_all.*kind) {
      if (point.row % 4 != 3) continue;
      point.row /= 4;  // counted among the measured ones
      expected.push_back(point);
    }
    CHECK(std::ranges::equal(features.*kind, expected, [](const auto& a, const auto& b) {
      return a.point_m == b.point_m && a.row == b.row;
    }));
  }
  CHECK(features.ground.size() > 100);
}

TEST_CASE("the tip of a wedge is the sharpest edge, also at a section's end, not in the ground") {
  // Sections of 60 points: 119 is the last of the second.
  for (const int tip : {100, 119}) {
    // A circle about the sensor with a wedge that reaches in from it.
    std::vector<float> m(360, 10.0F);
    for (int i = -12; i <= 12; ++i) m[tip + i] = 9.0F + 0.08F * static_cast<float>(std::abs(i));
    OneRow row(m);
    const auto features = row.features();
    CHECK(std::ranges::any_of(features.sharp_edges, [&](const slam::FeaturePoint& edge) {
      return edge.point_m == row.cloud.points_m[tip];
    }));
    if (tip == 100) CHECK(features.sharp_edges.at(0).point_m == row.cloud.points_m[tip]);
    std::ranges::fill(row.segmentation.pixel_class, slam::PixelClass::kGround);
    CHECK(row.features().edges.empty());
    CHECK_FALSE(row.features().flat_points.empty());
  }
}

TEST_CASE("the far side of a depth jump is never an edge, the near side may be one") {
  std::vector<float> range_m(360, 10.0F);
  for (int i = 100; i < 150; ++i) range_m[i] = 5.0F;
  const auto features = OneRow(range_m).features();
  CHECK(!features.edges.empty());
  for (const auto& edge : features.edges) CHECK(edge.point_m.norm() == doctest::Approx(5.0));
}

TEST_CASE("an edge on a post is the post's centre") {
  const SensorModel sensor = beams_at({0.04, 0.0, -0.04}, 360);
  RangeImage image = flat_image(3, 360, 10.0F);
  for (int row = 0; row < 3; ++row) std::fill_n(image.range_m.begin() + 360 * row + 100, 6, 5.0F);
  const OrganizedCloud cloud = unproject(image, sensor, CaptureTime::kMotionCorrected);
  const slam::Segmentation objects{std::vector(image.range_m.size(), slam::PixelClass::kObject)};
  const auto features = slam::extract_features(cloud, objects);
  REQUIRE(features.posts.size() == 3);
  CHECK(features.posts[0].point_m.norm() > 5.1F);
  REQUIRE(features.edges.size() == 3);
  for (int row = 0; row < 3; ++row) {
    CHECK(features.edges[row].point_m == features.posts[row].point_m);
    CHECK(features.sharp_edges[row].point_m == features.posts[row].point_m);
  }
}

TEST_CASE("a point whose both neighbours are 2 % away is on a surface along the beam and no edge") {
  // From 2 to 9.8 m by steps below the depth jump of 0.3 m and above 2 % of the range. Their size
  // changes every six points: where it does, the row is bent enough for an edge.
  constexpr int kBegin = 100;
  constexpr int kSteps = 30;
  std::vector<float> range_m(360, 2.0F);
  for (int i = 0; i < kSteps; ++i) {
    range_m[kBegin + i + 1] = range_m[kBegin + i] + (i / 6 % 2 == 0 ? 0.29F : 0.23F);
  }
  std::fill(range_m.begin() + kBegin + kSteps, range_m.end(), range_m[kBegin + kSteps]);
  const OneRow row(range_m);
  for (const auto& edge : row.features().edges) {
    for (int i = 1; i < kSteps; ++i) CHECK(edge.point_m != row.cloud.points_m[kBegin + i]);
  }
}

TEST_CASE("of the edges of a section two are sharp") {
  std::vector<float> range_m(360, 10.0F);
  for (const int tip : {70, 90, 110}) {
    for (int i = -6; i <= 6; ++i) {
      range_m[tip + i] = 10.0F - 0.08F * static_cast<float>(6 - std::abs(i));
    }
  }
  const auto features = OneRow(range_m).features();
  CHECK(features.sharp_edges.size() == 2);
  CHECK(features.edges.size() > 2);
}

TEST_CASE("a row of fewer than eleven points has no edges and does not crash") {
  for (const int count : {0, 1, 5, 10}) {
    std::vector<float> range_m(360, 0.0F);
    for (int i = 0; i < count; ++i) range_m[i] = 4.0F + static_cast<float>(i % 3);
    CHECK(OneRow(range_m).features().edges.empty());
  }
}

TEST_CASE("a circle around the sensor and the curve of a distant wall have no edges") {
  CHECK(OneRow(std::vector<float>(360, 10.0F)).features().edges.empty());
  // An oblique wall at 60 m: its curvature is small against its range.
  std::vector<float> range_m(1024);
  for (int i = 0; i < 1024; ++i) {
    const double angle_rad = (i - 512) * 2 * M_PI / 1024;
    range_m[i] = std::abs(angle_rad) < 1.0 ? static_cast<float>(60.0 / std::cos(angle_rad)) : 0.0F;
  }
  CHECK(OneRow(range_m).features().edges.empty());
}

TEST_CASE("edges of a yard are on its pillars and corners") {
  const Yard yard;
  const auto features = yard_features(small_sensor(32, 1024), yard);
  CHECK(features.sharp_edges.size() > 50);
  int on_pillar_or_corner = 0;
  for (const auto& edge : features.sharp_edges) {
    const Eigen::Vector2d p = edge.point_m.head<2>().cast<double>();
    bool explained = std::abs(std::abs(p.x()) - yard.half_length_m) < 0.5 &&
                     std::abs(std::abs(p.y()) - yard.half_width_m) < 0.5;
    for (int i = -3; i <= 3; ++i) {
      for (const double side : {-1.0, 1.0}) {
        explained |= (p - Eigen::Vector2d(8.0 * i + side, side * (9.0 + 0.7 * i))).norm() < 0.6;
      }
    }
    on_pillar_or_corner += explained;
  }
  CHECK(on_pillar_or_corner > 0.9 * static_cast<double>(features.sharp_edges.size()));
}

TEST_CASE("flat points are ground, sharp edges are among the edges, rows rise") {
  const auto features = yard_features(small_sensor(32, 1024), Yard());
  CHECK(features.flat_points.size() > 100);
  // The lowest point of a wall counts as ground where the floor before it is far away.
  int on_floor = 0;
  for (const auto& point : features.flat_points) on_floor += point.point_m.z() < -1.69F;
  CHECK(on_floor > 0.9 * static_cast<double>(features.flat_points.size()));
  std::set<std::pair<float, float>> edges;
  for (const auto& edge : features.edges) edges.emplace(edge.point_m.x(), edge.point_m.y());
  for (const auto& edge : features.sharp_edges) {
    CHECK(edges.count({edge.point_m.x(), edge.point_m.y()}) == 1);
  }
  for (const auto* kind : {&features.edges, &features.ground, &features.surfaces}) {
    for (std::size_t i = 1; i < kind->size(); ++i) CHECK((*kind)[i - 1].row <= (*kind)[i].row);
  }
}

TEST_CASE("two flat points of a row are never within five points of each other") {
  const SensorModel sensor = small_sensor(16, 720);
  const auto features = yard_features(sensor, {.pillars = false});
  REQUIRE(features.flat_points.size() > 20);
  for (std::size_t i = 0; i < features.flat_points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto& a = features.flat_points[i];
      const auto& b = features.flat_points[j];
      if (a.row != b.row) continue;
      const int between =
          std::abs(sensor.column_of(a.row, std::atan2(a.point_m.y(), a.point_m.x())) -
                   sensor.column_of(b.row, std::atan2(b.point_m.y(), b.point_m.x())));
      // The chosen are more than five points apart; the last and first point of a row are not
      // compared.
      CHECK((between > 5 || between == 0));
    }
  }
}
