#include "recording/pose_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "hqslam/core/error.h"
#include "hqslam/pipeline/pipeline.h"
#include "recording/reading.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

constexpr double kStretch_m = 1.0;
constexpr std::size_t kFewestStretches = 5;
constexpr std::size_t kMostStretches = 20;
constexpr int kMostScans = 300;
/// Right poses differ by up to 0.016 (simulated drives, KITTI's raw ones, a handheld OS0), those in
/// a camera's axes by 1.4.
constexpr double kMostDifference = 0.3;

struct BothPoses {
  Pose T_given_sensor;
  Pose T_slam_sensor;
};

/// Nothing for a stretch that is not finished.
std::optional<double> difference(const BothPoses& begin, const BothPoses& end) {
  const auto moved_m = [](const Pose& before, const Pose& after) -> Eigen::Vector3d {
    return (before.inverse() * after).translation();
  };
  const Eigen::Vector3d by_slam_m = moved_m(begin.T_slam_sensor, end.T_slam_sensor);
  if (by_slam_m.norm() < kStretch_m) return std::nullopt;
  return (moved_m(begin.T_given_sensor, end.T_given_sensor) - by_slam_m).norm() / by_slam_m.norm();
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

}  // namespace

PoseCheck check_poses(const pipeline::ScanPoses& poses, recordings::Recording& recording,
                      const InterruptGuard& interrupt) {
  pipeline::PipelineOptions options;
  options.slam_options.loop_closing.enabled = false;
  pipeline::Pipeline pipeline(recording.sensor(), options);
  std::vector<double> differences;
  std::optional<BothPoses> begin;
  int scans = 0;
  int more_upright = 0;  // than upside down
  Reading reading;
  read_scans(recording, interrupt, reading, [&](const ReadScan& read) {
    const auto now = located(poses, read, pipeline);
    const auto found = now && begin ? difference(*begin, *now) : std::nullopt;
    if (now) more_upright += is_upright(*now) ? 1 : -1;
    if (found) differences.push_back(*found);
    if (found || !now || !begin) begin = now;
    return ++scans < kMostScans && differences.size() < kMostStretches;
  });
  PoseCheck result{std::nullopt, more_upright < 0};
  if (differences.size() < kFewestStretches) return result;
  const auto middle = differences.begin() + std::ssize(differences) / 2;
  std::ranges::nth_element(differences, middle);
  result.motion_difference = *middle;
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
  if (found.motion_difference > kMostDifference) {
    to_stderr("hqslam: {}: its motion differs from that of the scans by {:.0f} % over 1 m; {}\n",
              path, 100.0 * *found.motion_difference, kExpected);
  } else if (found.is_upside_down) {
    to_stderr("hqslam: {}: its z points down where the scans have the ground below; {}\n", path,
              kExpected);
  }
}

}  // namespace hqslam::tools
