#pragma once

#include <cmath>

#include "table/table_figures.h"

namespace hqslam::test {

/// 40 poses, 10 m apart on a half circle, moved up by `bump_m` at every second one.
inline Trajectory example_trajectory(double bump_m) {
  Trajectory trajectory;
  for (int i = 0; i < 40; ++i) {
    StampedPose pose;
    pose.stamp_s = 0.1 * i;
    const double angle_rad = 3.14159265358979 * i / 39.0;
    pose.T_map_sensor.translation() = Eigen::Vector3d(
        124.0 * std::cos(angle_rad), 124.0 * std::sin(angle_rad), i % 2 == 0 ? bump_m : -bump_m);
    trajectory.push_back(pose);
  }
  return trajectory;
}

/// A method's result with a trajectory that is off by bump_m, twice that with loop closing.
inline tools::TableResult example_result(const tools::TableMethod& method, double bump_m) {
  tools::TableResult result;
  result.method = method;
  result.settings = {"build 1", "drive", "os1-64 0", 40, true, method.name, "", ""};
  if (tools::uses_network(method)) {
    result.settings.weights = method.source + ".npz";
    result.settings.weights_hash = "hash 17";
    result.network = tools::NetworkSize{175000, 367000000};
  }
  if (!method.source.empty()) {
    result.images = tools::ImageScores{40, 2.5, 0.25, 0.0625};
    result.timings.upsampling_s = 0.2;
    result.timings.upsampling_ms = 4.0;
    result.timings.points_s = 0.2;
  }
  result.trajectory = {example_trajectory(bump_m), example_trajectory(2.0 * bump_m)};
  result.loops_closed = 3;
  result.timings.slam = {tools::SlamTimings{0.4, 10.0, 11.0},
                         tools::SlamTimings{1.6, std::nullopt, std::nullopt}};
  result.timings.processor = "a processor";
  result.timings.instruction_set = "portable";
  return result;
}

}  // namespace hqslam::test
