#include "hqslam/slam/scan_context.h"

#include "slam/cloud_of.h"
#include "slam/village.h"

using namespace hqslam::slam;

TEST_CASE("a bin of a scan context holds how high its highest point reaches") {
  // Two points in one bin, one nearer in the same sector, one behind the sensor, one too far.
  const ScanContext context = scan_context(cloud_of({{10.0F, 0.5F, 0.0F},
                                                     {10.0F, 0.5F, 2.0F},
                                                     {5.0F, 0.2F, 1.0F},
                                                     {-30.0F, -0.1F, 0.0F},
                                                     {90, 1, 0}}));
  // Ring 2 holds 8 to 12 m and ring 1 4 to 8 m; heights are from 2 m below the sensor.
  CHECK(context.unit_sectors(2, 0) == doctest::Approx(4.0 / 5.0));
  CHECK(context.unit_sectors(1, 0) == doctest::Approx(3.0 / 5.0));
  CHECK(context.unit_sectors(7, 30) == doctest::Approx(1.0));
  CHECK(context.unit_sectors.sum() == doctest::Approx(0.8 + 0.6 + 1.0));
}

TEST_CASE("a place is recognized at any heading, and the rotation is found") {
  const Village village = street(1, -60.0, 120.0);
  for (const int rows : {16, 64}) {
    const SensorModel sensor = small_sensor(rows, 360);
    const ScanContext first = scan_context(village.scan(sensor, yard_pose(0.0, 0.0, 0.2)));
    for (const double yaw_rad : {-2.5, -0.6, 0.0, 1.3, 3.0}) {
      const ScanContext turned =
          scan_context(village.scan(sensor, yard_pose(0.3, -0.2, 0.2 + yaw_rad)));
      const auto match = compare(first, turned, 0.0, M_PI);
      CAPTURE(rows);
      CAPTURE(yaw_rad);
      CHECK(match.distance < 0.2);
      CHECK(std::abs(std::remainder(match.yaw_rad - yaw_rad, 2.0 * M_PI)) < 0.11);
      // With a rough idea of the turn only turns near it are tried.
      CHECK(compare(first, turned, yaw_rad + 0.1, 0.2).distance == match.distance);
      CHECK(compare(first, turned, yaw_rad + 1.0, 0.2).distance > match.distance + 0.05);
    }
  }
}

TEST_CASE("other places differ at any rotation") {
  const Village village = street(1, -60.0, 120.0);
  const ScanContext here = scan_context(village.scan(yard_pose(0.0, 0.0, 0.0)));
  const double again =
      compare(here, scan_context(village.scan(yard_pose(0.5, 0.5, 1.0))), 0.0, M_PI).distance;
  for (const unsigned seed : {2U, 3U, 4U, 5U}) {
    const ScanContext there =
        scan_context(street(seed, -60.0, 120.0).scan(yard_pose(0.0, 0.0, 0.0)));
    CHECK(compare(here, there, 0.0, M_PI).distance > 2.0 * again);
  }
}

TEST_CASE("a point farther away than an integer counts rings changes nothing") {
  const std::vector<Eigen::Vector3f> points_m = {{10.0F, 0.5F, 0.0F}, {-30.0F, -0.1F, 0.0F}};
  std::vector<Eigen::Vector3f> with_far_m = points_m;
  for (const float far_m : {1e4F, 9e9F, 3e18F, 3e38F}) with_far_m.emplace_back(-far_m, far_m, 1.0F);
  OrganizedCloud cloud = cloud_of(with_far_m);
  cloud.range_m.back() = 1.0F;
  const ScanContext context = scan_context(cloud);
  CHECK(context.unit_sectors == scan_context(cloud_of(points_m)).unit_sectors);
  CHECK(context.has_returns == scan_context(cloud_of(points_m)).has_returns);
}

TEST_CASE("the context of an empty scan matches nothing") {
  const ScanContext empty = scan_context(OrganizedCloud(16, 360));
  const ScanContext something = scan_context(cloud_of({{10.0F, 0.5F, 0.0F}}));
  CHECK(compare(empty, something, 0.0, M_PI).distance == 1.0);
  CHECK(compare(empty, empty, 0.0, M_PI).distance == 1.0);
}
