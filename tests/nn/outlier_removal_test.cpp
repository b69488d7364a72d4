#include "hqslam/nn/hqs/outlier_removal.h"

#include "outlier_masks.h"

namespace hqslam::nn {
TEST_CASE("options that make no sense are refused") {
  const SensorModel sensor = sensor_preset("os1-64");
  const RowSelection rows{3, 4};
  CHECK_NOTHROW(OutlierRemoval(sensor, rows, {}, sensor.columns));
  CHECK_NOTHROW(OutlierRemoval(sensor, rows, {}, 1));
  for (const double angle_rad : {0.0, -0.1, 1.5708, std::nan("")}) {
    CHECK_THROWS_AS(OutlierRemoval(sensor, rows, {.min_angle_rad = angle_rad}, 512), Error);
  }
  CHECK_THROWS_AS(OutlierRemoval(sensor, rows, {.min_pixels = -1}, 512), Error);
  for (const int columns : {0, -5, sensor.columns + 1}) {
    CHECK_THROWS_AS(OutlierRemoval(sensor, rows, {}, columns), Error);
  }
  CHECK_THROWS_AS(OutlierRemoval(sensor, {-1, 4}, {}, 512), Error);
  CHECK_THROWS_AS(OutlierRemoval(sensor, {3, 0}, {}, 512), Error);
}

TEST_CASE("a pixel of a measured row is never rejected but counts for its component") {
  const SensorModel sensor = degrees_apart(8, 360);
  OutlierRemoval removal(sensor, {3, 4}, {}, 360);
  RangeImage image(8, 360);
  draw_run(image, 3, 10, 19);  // measured; 10 + 10
  draw_run(image, 4, 10, 19);
  draw_run(image, 7, 50, 50);  // measured, alone
  draw_run(image, 6, 90, 90);  // not measured, alone
  Mask expected(image.range_m.size(), 0);
  expected[image.index(6, 90)] = 1;
  CHECK(found(removal, image) == expected);
}

TEST_CASE("ranges that are no ranges are no returns") {
  std::mt19937 generator(23);
  const SensorModel sensor = degrees_apart(6, 100);
  OutlierRemoval removal(sensor, kNothingMeasured, {}, 100);
  for (const float value : {-0.0F, -3.0F, std::nanf(""), HUGE_VALF, -HUGE_VALF, 1e-42F}) {
    RangeImage image = random_image(Kind::kPatches, 6, 100, generator);
    for (int i = 0; i < 200; ++i) image.range_m[generator() % 600] = value;
    CHECK(found(removal, image) == from_component_labeler(image, sensor, kNothingMeasured, {}));
  }
}

TEST_CASE("negative ranges are no returns at angles at which the formula connects them") {
  std::mt19937 generator(25);
  for (const int columns : {3, 9}) {
    SensorModel sensor = degrees_apart(5, columns);
    for (double& elevation_rad : sensor.beam_elevation_rad) elevation_rad *= 30.0;
    for (const int min_pixels : {2, 3, 5, 8}) {
      const OutlierRemovalOptions options{89.0 * kDegree_rad, min_pixels};
      OutlierRemoval removal(sensor, kNothingMeasured, options, columns);
      int wrong = 0;
      for (int i = 0; i < 200; ++i) {
        RangeImage image = random_image(Kind::kMesh, 5, columns, generator);
        for (float& range_m : image.range_m) range_m = range_m > 0.0F ? 1.0F : -10.0F;
        wrong += found(removal, image) !=
                 from_component_labeler(image, sensor, kNothingMeasured, options);
      }
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("a small component stays where a measured range nearby supports it") {
  const SensorModel sensor = degrees_apart(8, 64);
  std::vector<float> range_m(8 * 64, 0.0F);
  const auto at = [&](int row, int column) -> float& { return range_m[row * 64 + column]; };
  at(3, 10) = 20.0F;   // measured
  at(1, 11) = 20.15F;  // within 1 % of it, a column beside it
  at(5, 9) = 19.9F;    // below it
  at(5, 10) = 20.3F;   // not within 1 %
  at(5, 12) = 20.0F;   // two columns away
  at(3, 63) = 9.0F;
  at(2, 0) = 9.05F;  // round the circle
  at(7, 40) = 5.0F;  // measured itself
  std::vector<std::uint8_t> rejected(range_m.size());
  OutlierRemovalOptions options{.support_share = 0.01F};
  for (const int threads : {1, 2}) {
    OutlierRemoval(sensor, {3, 4}, options, 64).find(range_m.data(), rejected.data(), threads);
    std::vector<int> rejected_pixels;
    for (int i = 0; i < 8 * 64; ++i) {
      if (rejected[i] != 0) rejected_pixels.push_back(i);
    }
    CHECK(rejected_pixels == std::vector<int>{5 * 64 + 10, 5 * 64 + 12});
  }
  options.support_share = -0.5F;
  CHECK_THROWS_AS(OutlierRemoval(sensor, {3, 4}, options, 64), Error);
}

}  // namespace hqslam::nn
