#include "hqslam/pipeline/drive_memory.h"

#include "hqslam/core/projection.h"
#include "tools/program/untrained_weights.h"

namespace hqslam::pipeline {
namespace {

constexpr double kSpeed_m_per_s = 20.0;

/// Where a sensor that drives straight on is at each column of a scan that begins at one of them.
nn::ColumnPoses poses_of_scan_from(int first_column) {
  SensorModel sensor = sensor_preset("os1-64");
  const RowSelection rows{3, 4};
  sensor.measured_rows = rows;
  OrganizedCloud cloud = unproject(flat_image(16, sensor.columns, 10.0F), select_rows(sensor, rows),
                                   CaptureTime::kRolling);
  for (int row = 0; row < cloud.rows; ++row) {
    for (int column = 0; column < cloud.columns; ++column) {
      const int head = sensor.firing_column(rows.offset + row * rows.stride, column);
      const int turned = (head - first_column + sensor.columns) % sensor.columns;
      cloud.time_offset_s[cloud.index(row, column)] =
          static_cast<float>(sensor.scan_period_s * ((turned + 0.5) / sensor.columns - 0.5));
    }
  }
  Trajectory trajectory;
  for (int scan = 0; scan < 3; ++scan) {
    const double x_m = kSpeed_m_per_s * sensor.scan_period_s * (scan - 1);
    trajectory.push_back({sensor.scan_period_s * scan, Pose(Eigen::Translation3d(x_m, 0.0, 0.0))});
  }
  return column_poses({trajectory, 1}, cloud, sensor);
}

}  // namespace

TEST_CASE("the poses of a scan's columns follow the times of its points, wherever it begins") {
  for (const int first : {0, 1, 300, 1020}) {
    CAPTURE(first);
    const nn::ColumnPoses poses = poses_of_scan_from(first);
    REQUIRE(poses.size() == 1024);
    for (int column = 0; column < 1024; ++column) {
      const int turned = (column - first + 1024) % 1024;
      const double expected_m = kSpeed_m_per_s * 0.1 * ((turned + 0.5) / 1024 - 0.5);
      CHECK(std::abs(poses[column].translation().x() - expected_m) < 0.004);
    }
  }
  SensorModel sensor = sensor_preset("os1-64");
  sensor.measured_rows = RowSelection{3, 4};
  const OrganizedCloud corrected(16, sensor.columns);  // for motion: it has one pose
  CHECK(column_poses(slam::SensorPath(Pose::Identity()), corrected, sensor).size() == 1);
}

TEST_CASE("without looking ahead a scan recalls those before it, also of a sensor that stands") {
  const SensorModel sensor = sensor_preset("os1-64");
  const nn::Upsampler upsampler(nn::SuperResolver::load(untrained_file("du-mix", "scan_memory")),
                                sensor);
  const OrganizedCloud measured = unproject(flat_image(16, sensor.columns, 10.0F),
                                            select_rows(sensor, {3, 4}), CaptureTime::kRolling);
  ScanPoses poses;
  for (int scan = 0; scan < 30; ++scan) poses.trajectory.push_back({0.1 * scan, Pose::Identity()});
  LookAheadMemory memory(&upsampler, poses, /*looks_ahead=*/false);
  CHECK(memory.look_ahead_scans() == 0);
  for (int scan = 0; scan < 30; ++scan) {
    const nn::RecalledImage recalled = memory.recall(measured, scan, 0.1 * scan);
    const auto pixels =
        std::ranges::count_if(recalled.image.range_m, [](float range_m) { return range_m > 0.0F; });
    CAPTURE(scan);
    CHECK((pixels > 10000) == (scan > 0));
  }
  CHECK(memory.scans_with_pose() == 30);
  CHECK(memory.scans_without_pose() == 0);
}

}  // namespace hqslam::pipeline
