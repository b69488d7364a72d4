#include "recording/pose_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/evaluation/trajectory_error.h"
#include "hqslam/pipeline/pipeline.h"
#include "recording/reading.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

constexpr double kStretch_m = 1.0;
constexpr std::size_t kFewestStretches = 5;
constexpr std::size_t kManyStretches = 20;
constexpr int kMostScans = 300;
/// Least turn that shows whether poses turn with the scans: half a corner.
constexpr double kManyTurns_rad = 0.8;
/// Right poses differ by up to 0.015 (KITTI, a handheld OS0; 0.006 in simulated drives of five
/// kinds), a tenth of scale or five degrees of yaw make 0.09 to 0.1.
constexpr double kMostMotionDifference = 0.08;
/// Right ones differ by up to 0.05, poses 0.2 s late by 0.16 to 1.1, mirrored ones by 2.
constexpr double kMostTurnDifference = 0.15;
struct BothPoses {
  Pose T_given_sensor;
  Pose T_slam_sensor;
};

/// The motion over a stretch.
struct BothMotions {
  Pose given;
  Pose by_slam;

  double difference() const {
    return (given.translation() - by_slam.translation()).norm() / by_slam.translation().norm();
  }
  double turn_rad() const { return rotation_angle_rad(by_slam); }
  double turn_difference_rad() const { return rotation_angle_rad(by_slam.inverse() * given); }
};

/// Nothing for a stretch that is not finished.
std::optional<BothMotions> stretch(const BothPoses& begin, const BothPoses& end) {
  const BothMotions moved{begin.T_given_sensor.inverse() * end.T_given_sensor,
                          begin.T_slam_sensor.inverse() * end.T_slam_sensor};
  if (moved.by_slam.translation().norm() < kStretch_m) return std::nullopt;
  return moved;
}

bool is_upright(const BothPoses& poses) {
  const Eigen::Matrix3d R_given_slam =
      poses.T_given_sensor.linear() * poses.T_slam_sensor.linear().transpose();
  return R_given_slam(2, 2) > 0.0;
}

/// Nothing where one of them is unknown.
std::optional<BothPoses> located(const pipeline::ScanPoses& poses, const ReadScan& read,
                                 pipeline::Pipeline& pipeline) {
  try {
    const slam::ScanReport report = pipeline.process(read.scan).report;
    const auto path = poses.path_of(read.index, read.scan.stamp_s, pipeline.sensor().scan_period_s);
    if (!path || report.mapping_status != slam::Status::kOk) return std::nullopt;
    return BothPoses{path->at(0.0), report.T_map_sensor};
  } catch (const ScanError&) {
    return std::nullopt;
  }
}

double median_difference(const std::vector<BothMotions>& motions) {
  std::vector<double> differences;
  for (const BothMotions& motion : motions) differences.push_back(motion.difference());
  return statistics_of(differences).median;
}

}  // namespace

PoseCheck check_poses(const pipeline::ScanPoses& poses, recordings::Recording& recording,
                      const InterruptGuard& interrupt) {
  pipeline::PipelineOptions options;
  options.slam_options.loop_closing.enabled = false;
  pipeline::Pipeline pipeline(recording.sensor(), options);
  std::vector<BothMotions> motions;
  std::optional<BothPoses> begin;
  int scans = 0;
  int more_upright = 0;  // than upside down
  double turns_rad = 0.0;
  double turn_differences_rad = 0.0;
  Reading reading;
  read_scans(recording, interrupt, reading, [&](const ReadScan& read) {
    const auto now = located(poses, read, pipeline);
    const auto moved = now && begin ? stretch(*begin, *now) : std::nullopt;
    if (now) more_upright += is_upright(*now) ? 1 : -1;
    if (moved) {
      motions.push_back(*moved);
      turns_rad += moved->turn_rad();
      turn_differences_rad += moved->turn_difference_rad();
    }
    if (moved || !now || !begin) begin = now;
    return ++scans < kMostScans && (motions.size() < kManyStretches || turns_rad < kManyTurns_rad);
  });
  PoseCheck result;
  result.is_upside_down = more_upright < 0;
  if (motions.size() < kFewestStretches) return result;
  result.motion_difference = median_difference(motions);
  if (turns_rad >= kManyTurns_rad) result.turn_difference = turn_differences_rad / turns_rad;
  return result;
}

void warn_of_wrong_poses(
    const pipeline::ScanPoses& poses, const std::string& path, const InterruptGuard& interrupt,
    const std::function<std::unique_ptr<recordings::Recording>()>& open_recording) {
  if (path.empty()) return;
  const PoseCheck found = check_poses(poses, *open_recording(), interrupt);
  constexpr const char* kExpected =
      "expected are the sensor's poses on this drive, x forward, y left, z up, in TUM's or KITTI's "
      "order of numbers";
  if (found.motion_difference > kMostMotionDifference) {
    to_stderr("hqslam: {}: its motion differs from that of the scans by {:.0f} % over 1 m; {}\n",
              path, 100.0 * *found.motion_difference, kExpected);
  } else if (found.turn_difference > kMostTurnDifference) {
    to_stderr(
        "hqslam: {}: its turns differ from those of the scans by {:.0f} %; {}, at the stamps "
        "of the scans\n",
        path, 100.0 * *found.turn_difference, kExpected);
  } else if (found.is_upside_down) {
    to_stderr("hqslam: {}: its z points down where the scans have the ground below; {}\n", path,
              kExpected);
  }
}

}  // namespace hqslam::tools
