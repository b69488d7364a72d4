#include "hqslam/pipeline/pipeline.h"

#include "hqslam/slam/scan_trace.h"
#include "slam/yard_drive.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::pipeline {
namespace {

const SensorModel kSensor = sensor_preset("os1-16");

RecordedScan recorded_scan(int i) {
  RecordedScan scan;
  scan.stamp_s = kDrivePeriod_s * i;
  scan.cloud = drive_scan(kSensor, i);
  return scan;
}

}  // namespace

TEST_CASE("without an upsampling the pipeline is SLAM, bit by bit, of a driver's points too") {
  Pipeline pipeline(kSensor);
  Pipeline of_driver(kSensor);
  slam::ScanTrace trace;
  slam::Slam slam(kSensor);
  for (int i = 0; i < 8; ++i) {
    const RecordedScan scan = recorded_scan(i);
    slam.process(scan.cloud, scan.stamp_s);
    pipeline.process(scan);
    Scan points = returns_of(scan.cloud);
    points.stamp_s = scan.stamp_s;
    of_driver.process(points, &trace);
    CHECK_FALSE(trace.features.empty());
  }
  pipeline.finish();
  REQUIRE(pipeline.trajectory().size() == 8);
  for (std::size_t i = 0; i < 8; ++i) {
    const Pose& expected = slam.trajectory()[i].T_map_sensor;
    CHECK(pipeline.trajectory()[i].T_map_sensor.matrix() == expected.matrix());
    CHECK(of_driver.trajectory()[i].T_map_sensor.matrix() == expected.matrix());
  }
  CHECK(pipeline.map_points_m() == slam.map_points_m());
  CHECK(pipeline.sensor() == kSensor);
}

TEST_CASE("a network with a memory recalls the scans before, as SLAM located them") {
  const std::string weights = untrained_file("du-mix", "scan_memory");
  Pipeline pipeline(kSensor, {.upsampling = {.method = weights}});
  Upsampler alone(kSensor, {.method = weights});
  for (int i = 0; i < 3; ++i) {
    const RecordedScan scan = recorded_scan(i);
    const LocatedScan located = pipeline.process(scan);
    CHECK(located.cloud.rows == 64);
    CHECK(located.upsampling_s > 0.0);
    CHECK((located.cloud.range_m == alone.upsampled(alone.measured(scan.cloud)).range_m) ==
          (i == 0));
  }
}

}  // namespace hqslam::pipeline
