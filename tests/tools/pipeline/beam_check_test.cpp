#include "hqslam/pipeline/beam_check.h"

#include "slam/yard_drive.h"

namespace hqslam::pipeline {
namespace {

const SensorModel kDriven = sensor_preset("os1-16");

}  // namespace

TEST_CASE("each row is corrected by its beam, one that was not used by the nearest that was") {
  SensorModel sensor = sensor_preset("os1-64");
  sensor.elevation_correction_rad.assign(64, 0.5);
  sensor.range_correction_m.assign(64, 0.25);
  slam::BeamCalibration found;
  for (int beam = 0; beam < 16; ++beam) {
    found.beams.push_back({.elevation_rad = 0.001 * (beam + 1),
                           .range_m = -0.01 * (beam + 1),
                           .before = {},
                           .after = {}});
  }
  const SensorModel result = corrected(sensor, RowSelection{3, 4}, found);
  const auto check = [&](std::size_t row, int beam) {
    CAPTURE(row);
    CHECK(result.elevation_correction_rad[row] == doctest::Approx(0.5 + 0.001 * (beam + 1)));
    CHECK(result.range_correction_m[row] == doctest::Approx(0.25 - 0.01 * (beam + 1)));
  };
  check(0, 0);  // above the first one that was used
  check(3, 0);
  check(4, 0);  // a row below it
  check(6, 1);  // a row above the next
  check(63, 15);
  CHECK(result.beam_elevation_rad == sensor.beam_elevation_rad);
}

TEST_CASE("beams have errors where corrections make surfaces thinner without a bent world") {
  slam::BeamCalibration found;
  found.beams.resize(16);
  for (slam::BeamCorrection& beam : found.beams) beam.elevation_rad = 0.0005;
  found.residual_before_m = 0.0200;
  found.residual_after_m = 0.0193;
  CHECK(has_errors(found));
  found.residual_after_m = 0.0195;
  CHECK_FALSE(has_errors(found));
  found.residual_after_m = 0.0190;  // 6.2 mm gained
  CHECK(has_errors(found));
  for (slam::BeamCorrection& beam : found.beams) beam.elevation_rad = 0.003;
  CHECK_FALSE(has_errors(found));  // by 30 mm at 10 m
}

TEST_CASE("corrections larger than those of any known sensor are complained about") {
  SensorModel sensor = sensor_preset("vlp-16");
  CHECK(complaint_about(sensor).empty());
  sensor.elevation_correction_rad.assign(16, 0.0);
  sensor.elevation_correction_rad[3] = -0.69 * kDegree_rad;
  CHECK(complaint_about(sensor).empty());
  sensor.elevation_correction_rad[3] = -0.93 * kDegree_rad;
  CHECK(one_line_with(complaint_about(sensor), "reach 0.93 degrees", "'vlp-16'"));
}

TEST_CASE("a scan is kept for each metre of path, as far as wanted, with the trajectory's poses") {
  Pipeline pipeline(kDriven);
  BeamCheck beams(3.0);
  int processed = 0;
  const auto process_next = [&] {
    const OrganizedCloud cloud = drive_scan(kDriven, processed);
    beams.add(cloud, pipeline.process(cloud, kDrivePeriod_s * processed++).report, pipeline);
  };
  while (processed < 100 && !beams.is_complete()) process_next();
  REQUIRE(beams.is_complete());
  CHECK_FALSE(beams.is_lost());
  CHECK(beams.path_m() == doctest::Approx(3.0).epsilon(0.2));
  const std::vector<slam::LocatedScan> scans = beams.scans(pipeline.trajectory());
  REQUIRE(scans.size() >= 3);
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const double step_m =
        (scans[i].T_map_sensor.translation() - scans[i - 1].T_map_sensor.translation()).norm();
    CHECK(step_m >= 1.0);
    CHECK(step_m < 1.5);
    CHECK(scans[i].velocity.linear.norm() > 0.0);
    CHECK(scans[i].cloud.rows == kDriven.rows());
  }
  const std::size_t kept = scans.size();
  process_next();
  CHECK(beams.scans(pipeline.trajectory()).size() == kept);
}

TEST_CASE("scans of fog are not kept: their short view does not tell beams from the path") {
  Pipeline pipeline(kDriven);
  BeamCheck beams(3.0);
  for (int i = 0; i < 40; ++i) {
    const OrganizedCloud cloud = drive_scan(kDriven, i);
    slam::ScanReport report = pipeline.process(cloud, kDrivePeriod_s * i).report;
    report.scattered = 1;
    beams.add(cloud, report, pipeline);
  }
  CHECK(beams.path_m() == 0.0);
  CHECK(beams.scans(pipeline.trajectory()).empty());
}

}  // namespace hqslam::pipeline
