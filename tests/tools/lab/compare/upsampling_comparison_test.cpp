#include "compare/upsampling_comparison.h"

#include "hqslam/core/projection.h"
#include "made_images.h"

namespace hqslam::tools {

TEST_CASE("what is said of computed pixels does not count measured rows") {
  SensorModel sensor = beams_at({0.3, 0.1, -0.1, -0.3}, 4);
  sensor.measured_rows = {1, 2};  // rows 1 and 3
  RangeImage image = flat_image(4, 4, 10.0F);
  const OrganizedCloud truth = unproject(image, sensor, CaptureTime::kMotionCorrected);
  image.at(0, 0) = 12.0F;   // wrong
  image.at(0, 1) = 10.01F;  // right, and in a voxel of 0.1 m with the truth
  image.at(2, 3) = 0.0F;    // missing
  UpsamplingScore score;
  add_errors({.image = image, .confidence = {}}, select_rows(truth, *sensor.measured_rows), truth,
             sensor, score);
  CHECK(score.right_share == 6.0 / 8.0);
  CHECK(score.missing_share == 1.0 / 8.0);
  CHECK(score.computed_f1 == doctest::Approx(2.0 * 6.0 / (7.0 + 8.0)));
  CHECK(score.f1 == doctest::Approx(2.0 * 14.0 / (15.0 + 16.0)));
}

TEST_CASE("weights are named by their files, by their paths where these names are the same") {
  const std::vector<std::string> all = {"a/one.npz", "a/last.npz", "b/last.npz"};
  CHECK(short_name(all[0], all) == "one");
  CHECK(short_name(all[1], all) == "a/last.npz");
  CHECK(short_name(all[2], all) == "b/last.npz");
}

}  // namespace hqslam::tools
