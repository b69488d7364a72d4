#include "segmentation.h"

#include "hqslam/lego_loam/lego_loam.h"
#include "slam/village.h"

using lego_loam::ScanTrace;
using lego_loam::SegmentedScan;

namespace {

const SensorModel kSensor = sensor_preset("os1-16");

SegmentedScan segmented(const RangeImage& image) {
  return lego_loam::Segmentation(kSensor).segment(unproject(image, kSensor, CaptureTime::kRolling));
}

}  // namespace

TEST_CASE("a cluster of five points is kept where it spans three rows, its first one included") {
  RangeImage image(16, kSensor.columns);
  for (const auto& [row, column] : {std::pair{6, 100}, {5, 100}, {5, 101}, {5, 102}, {4, 100}}) {
    image.at(row, column) = 5.0F;
  }
  CHECK(segmented(image).clusters == 1);
  CHECK(segmented(image).label[image.index(4, 100)] == 1);
  image.at(4, 100) = 0.0F;
  image.at(5, 103) = 5.0F;
  CHECK(segmented(image).clusters == 0);
  CHECK(segmented(image).label[image.index(6, 100)] == ScanTrace::kOutlier);
}

TEST_CASE("points above one another on flat ground are ground, also below an empty pixel") {
  OrganizedCloud cloud = Village().scan(kSensor, yard_pose(0, 0, 0));
  const int lowest = kSensor.rows() - 1;
  cloud.range_m[cloud.index(lowest - 2, 10)] = 0.0F;
  const SegmentedScan scan = lego_loam::Segmentation(kSensor).segment(cloud);
  CHECK(scan.label[cloud.index(lowest, 10)] == ScanTrace::kGround);
  CHECK(scan.label[cloud.index(lowest - 1, 10)] == ScanTrace::kGround);
  CHECK(scan.label[cloud.index(lowest - 2, 10)] == ScanTrace::kNoReturn);
  CHECK(scan.ground_points == std::ranges::count(scan.label, ScanTrace::kGround));
}

TEST_CASE("every fifth column of the ground is kept, and those at the seam") {
  const SegmentedScan scan =
      lego_loam::Segmentation(kSensor).segment(Village().scan(kSensor, yard_pose(0, 0, 0)));
  REQUIRE_FALSE(scan.rows.back().empty());
  for (const auto& point : scan.rows.back()) {
    CHECK(point.ground);
    CHECK((point.column % 5 == 0 || point.column <= 5 || point.column >= kSensor.columns - 5));
  }
}

TEST_CASE("a point keeps its row and the moment of its capture") {
  const auto point = lego_loam::point_of({1.0F, 2.0F, 3.0F}, 63, 0.9);
  CHECK(lego_loam::row_of(point) == 63);
  CHECK(lego_loam::sweep_fraction(point) == doctest::Approx(0.9).epsilon(1e-4));
}
