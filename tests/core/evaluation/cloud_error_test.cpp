#include "hqslam/evaluation/cloud_error.h"

#include "hqslam/evaluation/image_error.h"
#include "testing.h"

using Points = std::vector<Eigen::Vector3f>;

namespace {

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

TEST_CASE("errors of a few points are those done by hand") {
  // Voxels of 0.1 m from the origin on: cloud {0, 1, 30}, true {0, 1, 2}.
  const Points cloud = {{0.0F, 0, 0}, {0.05F, 0, 0}, {0.12F, 0, 0}, {3.05F, 0, 0}};
  const Points true_cloud = {{0.0F, 0, 0}, {0.12F, 0, 0}, {0.25F, 0, 0}};
  const CloudError error = cloud_error(cloud, true_cloud);
  CHECK(error.iou == doctest::Approx(2.0 / 4.0));
  CHECK(error.precision == doctest::Approx(2.0 / 3.0));
  CHECK(error.recall == doctest::Approx(2.0 / 3.0));
  CHECK(error.f1 == doctest::Approx(2.0 / 3.0));
  CHECK(error.outlier_share == doctest::Approx(1.0 / 4.0));
  const double to_true_m2 = (0.0 + 0.05 * 0.05 + 0.0 + 2.8 * 2.8) / 4.0;
  const double to_cloud_m2 = (0.0 + 0.0 + 0.13 * 0.13) / 3.0;
  CHECK(error.chamfer_m2 == doctest::Approx(to_true_m2 + to_cloud_m2));
}

TEST_CASE("empty clouds and coordinates that are not finite are refused") {
  CHECK(refused_with([] { cloud_error({}, {{1, 2, 3}}); }, "cloud", "at least one point", "none"));
  CHECK(refused_with([] { cloud_error({{1, 2, 3}}, {}); }, "true cloud"));
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity(), 1e30F}) {
    CHECK(refused_with([&] { cloud_error({{1, bad, 3}}, {{1, 2, 3}}); }, "cloud", "finite"));
  }
}

TEST_CASE("errors of a small image are those done by hand") {
  RangeImage image(2, 3);
  RangeImage true_image(2, 3);
  image.range_m = {10, 0, 5, 7, 0, -1};
  true_image.range_m = {12, 3, 5, 0, 0, std::numeric_limits<float>::quiet_NaN()};
  const ImageError error = image_error(image, true_image);
  CHECK(error.pixels == 6);
  CHECK(error.valid_pixels == 2);
  CHECK(error.mae_all_m == doctest::Approx((2.0 + 3.0 + 0.0 + 7.0) / 6.0));
  CHECK(error.mae_valid_m == doctest::Approx(1.0));
  CHECK(error.missing_share == doctest::Approx(1.0 / 3.0));   // the 3 m of 12, 3 and 5
  CHECK(error.invented_share == doctest::Approx(1.0 / 3.0));  // the 7 m of 10, 5 and 7
  CHECK(error.right_share == doctest::Approx(1.0 / 3.0));     // the 5 m of 12, 3 and 5
}

TEST_CASE("images without common returns have no error of valid pixels; shapes must be equal") {
  RangeImage image(1, 2);
  RangeImage true_image(1, 2);
  image.range_m = {4, 0};
  true_image.range_m = {0, 2};
  const ImageError error = image_error(image, true_image);
  CHECK(error.mae_all_m == doctest::Approx(3.0));
  CHECK(error.valid_pixels == 0);
  CHECK(error.mae_valid_m == 0.0);
  CHECK(error.missing_share == 1.0);
  CHECK(image_error({}, {}).missing_share == 0.0);
  CHECK(image_error({}, {}).mae_all_m == 0.0);
  CHECK(refused_with([] { image_error(RangeImage(2, 3), RangeImage(3, 2)); },
                     "expected an image of 3 x 2", "found 2 x 3"));
}

TEST_CASE("the nearest point is the one that a search of all points finds") {
  std::mt19937 generator(7);
  for (const int count : {1, 2, 12, 13, 14, 100, 2000}) {
    for (const unsigned cells : {1U, 3U, 100000U}) {
      CAPTURE(count);
      CAPTURE(cells);
      const auto points_m = points_on_a_grid(count, cells, generator);
      Points queries_m = points_on_a_grid(50, 2 * cells, generator);
      queries_m.push_back(points_m.front());
      queries_m.emplace_back(-1e5F, 3e4F, 1.0F);
      const std::vector<float> distances_m = nearest_distances_m(queries_m, points_m);
      for (std::size_t i = 0; i < queries_m.size(); ++i) {
        float nearest_m2 = std::numeric_limits<float>::infinity();
        for (const Eigen::Vector3f& p : points_m) {
          nearest_m2 = std::min(nearest_m2, (p - queries_m[i]).squaredNorm());
        }
        CHECK(distances_m[i] == static_cast<float>(std::sqrt(double{nearest_m2})));
      }
    }
  }
}
