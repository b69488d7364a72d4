#include "hqslam/pipeline/pipeline.h"

#include "hqslam/core/projection.h"
#include "hqslam/slam/scan_trace.h"
#include "slam/yard_drive.h"
#include "testing.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::pipeline {
namespace {

const SensorModel kSensor = sensor_preset("os1-16");

RecordedScan recorded_scan(int i) {
  RecordedScan scan;
  scan.stamp_s = test::kDrivePeriod_s * i;
  scan.cloud = test::drive_scan(kSensor, i);
  return scan;
}

Pipeline driven(const PipelineOptions& options, int scans) {
  Pipeline pipeline(kSensor, options);
  for (int i = 0; i < scans; ++i) pipeline.process(recorded_scan(i));
  pipeline.finish();
  return pipeline;
}

}  // namespace

TEST_CASE("without an upsampling the pipeline is SLAM, bit by bit") {
  const Pipeline pipeline = driven({}, 8);
  slam::Slam slam(kSensor);
  for (int i = 0; i < 8; ++i) slam.process(test::drive_scan(kSensor, i), test::kDrivePeriod_s * i);
  REQUIRE(pipeline.trajectory().size() == 8);
  for (std::size_t i = 0; i < 8; ++i) {
    CHECK(pipeline.trajectory()[i].T_map_sensor.matrix() ==
          slam.trajectory()[i].T_map_sensor.matrix());
  }
  CHECK(pipeline.map_points_m() == slam.map_points_m());
  CHECK(pipeline.sensor() == kSensor);
}

TEST_CASE("scans of a recording and a driver's points give the same pose") {
  Pipeline of_recording(kSensor);
  Pipeline of_driver(kSensor);
  for (int i = 0; i < 3; ++i) {
    const RecordedScan scan = recorded_scan(i);
    Scan points = returns_of(scan.cloud);
    points.stamp_s = scan.stamp_s;
    CHECK(of_driver.process(points).report.T_map_sensor.matrix() ==
          of_recording.process(scan).report.T_map_sensor.matrix());
  }
}

TEST_CASE("a network with a memory recalls the scans before, as SLAM located them") {
  const test::TemporaryDirectory folder;
  const std::string weights = folder.file("memory.npz");
  write_weights(weights, test::untrained_weights(sensor_preset("os1-64"), "du-mix", "scan_memory"));
  Pipeline pipeline(kSensor, {.upsampling = {.method = weights}});
  Upsampler alone(kSensor, {.method = weights});
  for (int i = 0; i < 3; ++i) {
    const RecordedScan scan = recorded_scan(i);
    const LocatedScan located = pipeline.process(scan);
    CHECK(located.cloud.rows == 64);
    CHECK(located.upsampling_s > 0.0);
    const bool is_as_alone =
        located.cloud.range_m == alone.upsampled(alone.measured(scan.cloud)).range_m;
    CHECK(is_as_alone == (i == 0));
  }
}

TEST_CASE("a trace shows what SLAM made of a scan") {
  Pipeline pipeline(kSensor);
  slam::ScanTrace trace;
  pipeline.process(recorded_scan(0));
  pipeline.process(recorded_scan(1), &trace);
  CHECK_FALSE(trace.features.empty());
}

}  // namespace hqslam::pipeline
