#pragma once

#include "run/slam_run.h"
#include "testing.h"

namespace hqslam::tools {

/// A run over `scans` scans straight ahead, 1 m per scan, 0.1 s apart, with 1 ms, 2 ms, 3 ms and
/// 4 ms in the four stages.
inline SlamRun example_run(int scans) {
  SlamRun run;
  run.input = "drive";
  run.sensor = sensor_preset("os1-64");
  run.threads = 2;
  run.scans_in_recording = scans;
  run.wall_s = 0.02 * scans;
  for (int i = 0; i < scans; ++i) {
    run.trajectory.push_back({0.1 * i, Pose(Eigen::Translation3d(i, 0.0, 0.0))});
    ScanRecord record;
    record.report.stamp_s = 0.1 * i;
    record.report.times = {0.001, 0.002, 0.003, 0.004, 0.0, 0.010};
    record.reading_s = 0.005;
    run.scans.push_back(record);
    run.map_points_m.emplace_back(static_cast<float>(i), 5.0F, 1.0F);
  }
  run.end = ReadingEnd::kComplete;
  run.submap_of_scan.resize(run.scans.size());
  run.segment_of_scan.resize(run.scans.size());
  return run;
}

/// A curved reference for it in another frame: `offset_m` to the left at the middle scan.
inline TrajectoryFile example_reference(const SlamRun& run, double offset_m) {
  TrajectoryFile reference;
  reference.path = "truth.tum";
  reference.has_stamps = true;
  reference.poses = run.trajectory;
  reference.poses[run.trajectory.size() / 2].T_map_sensor.translation().y() += offset_m;
  const Pose T_world_map = pose_from_xyz_rpy({100.0, -50.0, 3.0}, 0.0, 0.0, 1.0);
  for (StampedPose& pose : reference.poses) pose.T_map_sensor = T_world_map * pose.T_map_sensor;
  return reference;
}

/// That run, compared with that reference.
inline SlamRun compared_run(int scans, double offset_m) {
  SlamRun run = example_run(scans);
  run.comparison = compare_with_reference(run.trajectory, example_reference(run, offset_m));
  return run;
}

}  // namespace hqslam::tools
