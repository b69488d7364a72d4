#include "run/dense_map_run.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "hqslam/core/error.h"
#include "run/run_plan.h"
#include "run/slam_run.h"
#include "terminal/progress.h"
#include "timing/stopwatch.h"

namespace hqslam::tools {
namespace {

constexpr double kMostStampDifference_s = 0.02;

/// The pose whose stamp is nearest, nothing if it is too far.
std::optional<std::size_t> pose_at(const Trajectory& trajectory, double stamp_s) {
  const auto later =
      std::lower_bound(trajectory.begin(), trajectory.end(), stamp_s - kMostStampDifference_s,
                       [](const StampedPose& a, double limit_s) { return a.stamp_s < limit_s; });
  const auto nearest =
      std::min_element(later,
                       std::find_if(later, trajectory.end(),
                                    [&](const StampedPose& candidate) {
                                      return candidate.stamp_s > stamp_s + kMostStampDifference_s;
                                    }),
                       [&](const StampedPose& a, const StampedPose& b) {
                         return std::abs(a.stamp_s - stamp_s) < std::abs(b.stamp_s - stamp_s);
                       });
  const bool is_near =
      nearest != trajectory.end() && std::abs(nearest->stamp_s - stamp_s) <= kMostStampDifference_s;
  if (!is_near) return std::nullopt;
  return static_cast<std::size_t>(nearest - trajectory.begin());
}

/// The pose of a scan of the recording, nothing if it has none.
std::optional<std::size_t> pose_of_scan(const std::vector<std::int64_t>& scan_of_pose,
                                        std::int64_t scan) {
  const auto found = std::lower_bound(scan_of_pose.begin(), scan_of_pose.end(), scan);
  if (found == scan_of_pose.end() || *found != scan) return std::nullopt;
  return static_cast<std::size_t>(found - scan_of_pose.begin());
}

/// The pose of a scan, nothing if it is not known.
std::optional<std::size_t> pose_of(const ScanPoses& poses, std::int64_t scan, double stamp_s) {
  const auto pose = poses.scan_of_pose ? pose_of_scan(*poses.scan_of_pose, scan)
                                       : pose_at(poses.trajectory, stamp_s);
  if (pose && !poses.is_located.empty() && !poses.is_located[*pose]) return std::nullopt;
  return pose;
}

/// One reading of the recording.
struct Reading {
  RunPlan& plan;
  const ScanPoses& poses;
  const InterruptGuard& interrupt;
};

struct ReadingCounts {
  std::int64_t scans = 0;
  std::int64_t left_out = 0;
  LeftOut not_understood;
  std::string end_message;
};

/// Calls use(scan, path) for every scan whose pose is known.
ReadingCounts read_all(
    const Reading& reading, const std::string& label,
    const std::function<void(const RecordedScan&, const slam::SensorPath&)>& use) {
  const auto source = reading.plan.open();
  const auto& scans = reading.poses.scan_of_pose;
  std::optional<std::int64_t> most = source->size();
  if (scans && !scans->empty())
    most = std::min(most.value_or(scans->back() + 1), scans->back() + 1);
  Progress progress(label, most);
  ReadingCounts counts;
  const auto read = [&] { return counts.scans + counts.left_out + counts.not_understood.scans; };
  try {
    while ((!most || read() < *most) && !reading.interrupt.stop_requested()) {
      const std::optional<RecordedScan> scan = next_usable(*source, counts.not_understood);
      if (!scan) break;
      if (const auto pose = pose_of(reading.poses, read(), scan->stamp_s)) {
        use(*scan,
            slam::SensorPath(reading.poses.trajectory, *pose,
                             {reading.poses.knows_way(*pose - 1), reading.poses.knows_way(*pose)}));
        ++counts.scans;
      } else {
        ++counts.left_out;
      }
      progress.update(read(), source->read_share());
    }
  } catch (const Error& error) {
    if (counts.scans == 0) throw;
    counts.end_message = error.what();
  }
  progress.finish();
  return counts;
}

}  // namespace

ScanPoses poses_of(const SlamRun& run) {
  ScanPoses poses{run.trajectory, {}, {}, scan_of_pose(run)};
  for (std::size_t i = 0; i < run.scans.size(); ++i) {
    poses.is_located.push_back(slam::is_registered(run.scans[i].report.mapping_status) &&
                               run.part_of_scan[i] == run.map_part);
    if (i + 1 < run.scans.size()) poses.is_way_known.push_back(is_way_known(run, i));
  }
  return poses;
}

void declare_dense_map(CLI::App& command, DenseMapChoice& choice) {
  command.add_option("--map-voxel", choice.voxel_m, "Of the dense map: metres from point to point")
      ->check(CLI::Range(0.02, 1.0))
      ->capture_default_str();
  command
      .add_option("--map-confidence", choice.least_confidence,
                  "Of the dense map: least probability that a point is on a surface")
      ->check(CLI::Range(0.001, 0.999))
      ->capture_default_str();
}

DenseMapRun build_dense_map(const RecordingChoice& recording, const ScanPoses& poses,
                            const DenseMapChoice& choice, const InterruptGuard& interrupt) {
  const SteadyClock::time_point start = SteadyClock::now();
  nn::SuperResolverOptions network;
  network.tolerance_m = static_cast<float>(choice.voxel_m);
  network.least_confidence = slam::DenseMapOptions::kLeastPointConfidence;
  RecordingChoice all_points = recording;
  all_points.least_confidence.reset();
  all_points.tolerance_m.reset();
  RunPlan plan = plan_of(all_points, network);
  slam::DenseMapOptions options;
  options.voxel_m = choice.voxel_m;
  options.least_confidence = choice.least_confidence;
  slam::DenseMap map(options);
  const SlamRunSpec spec = plan.spec();
  const std::optional<RowSelection> computed_from = plan.upsampler ? plan.upsampler->measured_rows()
                                                    : plan.rows
                                                        ? std::nullopt
                                                        : plan.recording_sensor.measured_rows;
  const Reading reading{plan, poses, interrupt};
  const ReadingCounts inserted =
      read_all(reading, "dense map, points", [&](const RecordedScan& scan, const auto& path) {
        map.insert(prepared_cloud(measured_cloud(scan.cloud, spec), spec), computed_from, path);
      });
  const ReadingCounts voted =
      read_all(reading, "dense map, seen through", [&](const RecordedScan& scan, const auto& path) {
        const OrganizedCloud cloud = measured_cloud(scan.cloud, spec);
        map.see_through(
            plan.upsampler || !computed_from ? cloud : select_rows(cloud, *computed_from), path);
      });
  DenseMapRun run;
  run.points = map.points();
  run.voxel_m = choice.voxel_m;
  run.scans = inserted.scans;
  run.scans_left_out = inserted.left_out;
  run.not_understood = inserted.not_understood;
  run.is_full = map.is_full();
  run.end_message = inserted.end_message;
  run.wall_s = seconds_since(start);
  return run;
}

}  // namespace hqslam::tools
