#include "front_end/posts.h"

#include "front_end/scattered_returns.h"
#include "hqslam/core/projection.h"
#include "made_images.h"

namespace {

/// One level row with objects 10 m away, 0.17 m from column to column.
struct RowWithPosts {
  SensorModel sensor = beams_at({0.0}, 360);
  bool returns_fail = false;
  std::vector<float> range_m = std::vector<float>(360, 10.0F);
  slam::Segmentation segmentation{std::vector(360, slam::PixelClass::kObject)};

  void put(int first, int last, float range) {
    std::fill(range_m.begin() + first, range_m.begin() + last + 1, range);
    std::fill(segmentation.pixel_class.begin() + first, segmentation.pixel_class.begin() + last + 1,
              range > 0.0F ? slam::PixelClass::kObject : slam::PixelClass::kNoReturn);
  }
  OrganizedCloud cloud() const {
    RangeImage image(sensor.rows(), sensor.columns);
    image.range_m = range_m;
    return unproject(image, sensor, CaptureTime::kRolling);
  }
  std::vector<slam::FeaturePoint> posts() const {
    std::vector<slam::FeaturePoint> centres;
    for (const slam::Post& post : slam::posts_in_row(cloud(), segmentation, 0, returns_fail)) {
      centres.push_back(post.centre);
    }
    return centres;
  }
  /// A circle 15 m ahead, `turn_rad` beside the middle of the image, that answers every beam of 3
  /// mrad that touches it.
  void put_trunk(double radius_m, double turn_rad) {
    constexpr double kDistance_m = 15.0;
    const double middle_rad = sensor.azimuth_rad(0, sensor.columns / 2) + turn_rad;
    for (int column = 0; column < sensor.columns; ++column) {
      const double beside_rad = std::abs(sensor.azimuth_rad(0, column) - middle_rad);
      const double beside_m = kDistance_m * std::sin(std::max(beside_rad - 0.0015, 0.0));
      if (beside_rad > 0.1 || beside_m >= radius_m) continue;
      range_m[column] = static_cast<float>(kDistance_m * std::cos(beside_rad) -
                                           std::sqrt(radius_m * radius_m - beside_m * beside_m));
    }
  }
};

}  // namespace

TEST_CASE("a post is a little behind the mean of its points, at the time of the middle one") {
  RowWithPosts row;
  row.put(100, 102, 5.0F);
  const OrganizedCloud cloud = row.cloud();
  const auto posts = row.posts();
  REQUIRE(posts.size() == 1);
  const Eigen::Vector3f mean_m =
      (cloud.points_m[100] + cloud.points_m[101] + cloud.points_m[102]) / 3.0F;
  const float outer_m = (cloud.points_m[102] - cloud.points_m[100]).norm();
  const float width_m = outer_m + (0.017453F - 0.003F) * mean_m.norm();  // columns of 1 degree
  CHECK(posts[0].point_m.norm() == doctest::Approx(mean_m.norm() + 0.3927F * width_m));
  CHECK(posts[0].point_m.cross(mean_m).norm() < 1e-4F);
  CHECK(posts[0].time_offset_s == cloud.time_offset_s[101]);
  CHECK(posts[0].row == 0);
}

TEST_CASE("the middle of a trunk is found, at any distance of columns and width of trunk") {
  for (const int columns : {512, 1024, 2048}) {
    for (const double radius_m : {0.15, 0.3}) {
      double error_m = 0.0;
      constexpr int kPlaces = 40;  // between two columns
      for (int place = 0; place < kPlaces; ++place) {
        RowWithPosts row;
        row.sensor.columns = columns;
        row.range_m.assign(columns, 50.0F);
        row.segmentation.pixel_class.assign(columns, slam::PixelClass::kObject);
        row.put_trunk(radius_m, 2.0 * std::numbers::pi / columns * place / kPlaces);
        const auto posts = row.posts();
        REQUIRE(posts.size() == 1);
        error_m += (posts[0].point_m.norm() - 15.0) / kPlaces;
      }
      // By the outer points alone 0.02 to 0.06 m before the middle with 512 and 1,024 columns.
      CHECK(std::abs(error_m) < 0.012);
    }
  }
}

TEST_CASE("a single pixel before nothing is a post unless it is ground") {
  RowWithPosts row;
  row.put(90, 110, 0.0F);
  row.put(100, 100, 5.0F);
  CHECK(row.posts().size() == 1);
  row.segmentation.pixel_class[100] = slam::PixelClass::kGround;
  CHECK(row.posts().empty());
}

TEST_CASE("an object wider than a metre, occluded or at the seam of the image is no post") {
  RowWithPosts wide;
  wide.put(100, 111, 5.0F);  // 11 steps of 0.087 m
  CHECK(wide.posts().size() == 1);
  wide.put(100, 112, 5.0F);
  CHECK(wide.posts().empty());
  RowWithPosts row;
  row.put(100, 102, 5.0F);
  row.put(103, 140, 3.0F);
  CHECK(row.posts().empty());
  RowWithPosts at_seam;
  at_seam.put(0, 2, 5.0F);
  at_seam.put(358, 359, 5.0F);
  CHECK(at_seam.posts().empty());
}

TEST_CASE("a piece of a wall between holes is no post where returns fail, one before the sky is") {
  RowWithPosts wall;
  for (const int column : {97, 98, 99, 101, 102}) wall.put(column, column, 0.0F);
  CHECK(wall.posts().size() == 1);
  wall.returns_fail = true;
  CHECK(wall.posts().empty());
  wall.put(95, 99, 0.0F);
  wall.put(101, 105, 0.0F);
  wall.put(100, 100, 10.5F);
  CHECK(wall.posts().size() == 1);
}

TEST_CASE("where returns fail, what is near in one row alone is an echo") {
  RowWithPosts row;
  row.returns_fail = true;
  row.put(100, 102, 5.0F);
  CHECK(row.posts().empty());
  row.sensor = beams_at({0.5, 0.0}, 360);
  const std::vector<float> one = row.range_m;
  row.range_m.insert(row.range_m.end(), one.begin(), one.end());
  row.segmentation.pixel_class.resize(720, slam::PixelClass::kObject);
  CHECK(row.posts().size() == 1);
}

TEST_CASE("returns fail where many surfaces have holes of one pixel") {
  RowWithPosts row;
  for (int hole = 0; hole < 20; ++hole) row.put(10 * hole, 10 * hole, 0.0F);
  CHECK_FALSE(slam::has_failing_returns(row.cloud()));
  for (int hole = 0; hole < 40; ++hole) row.put(5 * hole, 5 * hole, 0.0F);
  CHECK(slam::has_failing_returns(row.cloud()));
  row.put(0, 359, 0.0F);
  CHECK_FALSE(slam::has_failing_returns(row.cloud()));
}

TEST_CASE("two posts side by side are two where one stands behind the other's gap") {
  RowWithPosts row;
  row.put(100, 101, 5.0F);
  row.put(105, 106, 5.2F);
  CHECK(row.posts().size() == 2);
  // Without a gap the nearer one hides the edge of the other.
  row.put(102, 104, 5.6F);
  CHECK(row.posts().size() == 2);
  RowWithPosts touching;
  touching.put(100, 101, 5.0F);
  touching.put(102, 103, 5.6F);
  const auto posts = touching.posts();
  REQUIRE(posts.size() == 1);
  CHECK(posts[0].point_m.norm() == doctest::Approx(5.063).epsilon(0.001));
}
