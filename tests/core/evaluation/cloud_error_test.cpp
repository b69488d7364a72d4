#include "hqslam/evaluation/cloud_error.h"

#include <doctest/doctest.h>

#include <limits>

#include "error_message.h"

using namespace hqslam;
using namespace hqslam::test;

namespace {

using Points = std::vector<Eigen::Vector3f>;

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

TEST_CASE("a cloud compared with itself, in any order, has no error") {
  Points cloud;
  for (int i = 0; i < 500; ++i) {
    cloud.emplace_back(0.01F * static_cast<float>(i * 37 % 500),
                       -0.3F * static_cast<float>(i * 11 % 17), static_cast<float>(i % 5));
  }
  Points reversed(cloud.rbegin(), cloud.rend());
  const CloudError error = cloud_error(cloud, reversed);
  CHECK(error.chamfer_m2 == 0.0);
  CHECK(error.iou == 1.0);
  CHECK(error.precision == 1.0);
  CHECK(error.recall == 1.0);
  CHECK(error.f1 == 1.0);
  CHECK(error.outlier_share == 0.0);
}

TEST_CASE("clouds that share no voxel overlap by nothing") {
  const CloudError error = cloud_error({{0, 0, 0}}, {{0, 0, 7}});
  CHECK(error.iou == 0.0);
  CHECK(error.f1 == 0.0);
  CHECK(error.outlier_share == 1.0);
  CHECK(error.chamfer_m2 == doctest::Approx(98.0));
}

TEST_CASE("missing points lower the recall alone, invented points the precision alone") {
  const Points all = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  const Points half = {{0, 0, 0}, {1, 0, 0}};
  CHECK(cloud_error(half, all).recall == 0.5);
  CHECK(cloud_error(half, all).precision == 1.0);
  CHECK(cloud_error(all, half).recall == 1.0);
  CHECK(cloud_error(all, half).precision == 0.5);
}

TEST_CASE("empty clouds and coordinates that are none are refused") {
  CHECK(one_line_with(error_message([] {
                        cloud_error({}, {{1, 2, 3}});
                      }),
                      "cloud", "at least one point", "none"));
  CHECK(one_line_with(error_message([] { cloud_error({{1, 2, 3}}, {}); }), "true cloud"));
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity(), 1e30F}) {
    CHECK(one_line_with(error_message([&] {
                          cloud_error({{1, bad, 3}}, {{1, 2, 3}});
                        }),
                        "cloud", "finite"));
  }
}

TEST_CASE("errors sum up to means, figure by figure") {
  CloudError sum{{0.5, 0.25, 1.0, 0.75}, 3.0, 0.125};
  sum += CloudError{{0.25, 0.75, 0.5, 0.25}, 1.0, 0.375};
  sum /= 2.0;
  CHECK(sum.iou == 0.375);
  CHECK(sum.precision == 0.5);
  CHECK(sum.recall == 0.75);
  CHECK(sum.f1 == 0.5);
  CHECK(sum.chamfer_m2 == 2.0);
  CHECK(sum.outlier_share == 0.25);
}
