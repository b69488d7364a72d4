#include "front_end/segmentation.h"

#include <doctest/doctest.h>

#include "slam/yard.h"

using namespace hqslam;
using slam::PixelClass;

namespace {

/// A sensor that looks up only, so that nothing is ground.
SensorModel upward_sensor(int rows, int columns) {
  SensorModel sensor;
  sensor.columns = columns;
  for (int row = 0; row < rows; ++row) sensor.beam_elevation_rad.push_back(0.3 - 0.01 * row);
  sensor.beam_azimuth_offset_rad.assign(rows, 0.0);
  return sensor;
}

struct Patch {
  int row, column, rows, columns;
};

slam::Segmentation segmented(const Patch& patch) {
  const SensorModel sensor = upward_sensor(16, 720);
  RangeImage image(16, 720);
  for (int row = patch.row; row < patch.row + patch.rows; ++row) {
    for (int k = 0; k < patch.columns; ++k) image.at(row, (patch.column + k) % 720) = 5.0F;
  }
  slam::Segmenter segmenter(sensor, {}, {});
  return segmenter.segment(unproject(image, sensor, CaptureTime::kMotionCorrected));
}

}  // namespace

TEST_CASE("30 pixels in one row are a cluster, 29 are an outlier") {
  CHECK(segmented({4, 100, 1, 30}).clusters == 1);
  const auto few = segmented({4, 100, 1, 29});
  CHECK(few.clusters == 0);
  CHECK(few.pixel_class[4 * 720 + 110] == PixelClass::kOutlier);
}

TEST_CASE("6 pixels over 3 rows are a cluster, over 2 rows they are not: the first row counts") {
  CHECK(segmented({4, 100, 3, 2}).clusters == 1);
  CHECK(segmented({4, 100, 2, 3}).clusters == 0);
}

TEST_CASE("a cluster across the seam of the scan is one cluster") {
  const auto result = segmented({4, 705, 1, 30});
  CHECK(result.clusters == 1);
  CHECK(result.pixel_class[4 * 720 + 719] == PixelClass::kCluster);
  CHECK(result.pixel_class[4 * 720 + 0] == PixelClass::kCluster);
}

TEST_CASE("every return of a yard is ground, cluster or outlier and they add up") {
  const SensorModel sensor = test::small_sensor(32, 720);
  slam::Segmenter segmenter(sensor, {}, {});
  const OrganizedCloud cloud = test::Yard().scan(sensor, test::yard_pose(0, 0, 0));
  const auto result = segmenter.segment(cloud);
  int returns = 0;
  int ground = 0;
  int none = 0;
  for (const PixelClass pixel_class : result.pixel_class) {
    none += pixel_class == PixelClass::kNoReturn;
    ground += pixel_class == PixelClass::kGround;
    returns += pixel_class != PixelClass::kNoReturn;
  }
  CHECK(result.returns == returns);
  CHECK(result.ground_points == ground);
  CHECK(ground > 0.2 * returns);
  CHECK(ground < 0.8 * returns);
  CHECK(result.clusters > 4);
}
