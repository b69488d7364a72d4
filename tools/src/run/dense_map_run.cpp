#include "run/dense_map_run.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "lift/lifted_input.h"
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

/// One reading of all scans whose pose may be known.
struct MapReading : Reading {
  std::int64_t scans = 0;         ///< with a pose that is known
  std::int64_t without_pose = 0;  ///< the others
};

/// Calls use(scan, path) for every scan whose pose is known.
MapReading read_all(LiftedInput& input, const ScanPoses& poses, const std::string& label,
                    const InterruptGuard& interrupt,
                    const std::function<void(const RecordedScan&, const slam::SensorPath&)>& use) {
  const auto source = input.open();
  const auto& scans = poses.scan_of_pose;
  std::optional<std::int64_t> most = source->size();
  if (scans && !scans->empty()) {
    most = std::min(most.value_or(scans->back() + 1), scans->back() + 1);
  }
  Progress progress(label, most);
  MapReading reading;
  read_scans(*source, interrupt, reading, [&](const ReadScan& read) {
    if (const auto pose = pose_of(poses, read.index, read.scan.stamp_s)) {
      use(read.scan, slam::SensorPath(poses.trajectory, *pose,
                                      {poses.knows_way(*pose - 1), poses.knows_way(*pose)}));
      ++reading.scans;
    } else {
      ++reading.without_pose;
    }
    progress.update(read.index + 1, source->read_share());
    return !most || read.index + 1 < *most;
  });
  progress.finish();
  return reading;
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

DenseMapRun build_dense_map(const InputChoice& recording, const LiftingChoice& lifting,
                            const ScanPoses& poses, const DenseMapChoice& choice,
                            const InterruptGuard& interrupt) {
  const SteadyClock::time_point start = SteadyClock::now();
  nn::SuperResolverOptions network;
  network.tolerance_m = static_cast<float>(choice.voxel_m);
  network.least_confidence = slam::DenseMapOptions::kLeastPointConfidence;
  LiftedInput input = lifted_input(recording, {lifting.upsample, lifting.rows}, network);
  slam::DenseMapOptions options;
  options.voxel_m = choice.voxel_m;
  options.least_confidence = choice.least_confidence;
  slam::DenseMap map(options);
  const std::optional<RowSelection> computed_from = input.upsampler
                                                        ? input.upsampler->measured_rows()
                                                    : input.rows ? std::nullopt
                                                                 : input.recorded.measured_rows;
  const MapReading inserted =
      read_all(input, poses, "dense map, points", interrupt,
               [&](const RecordedScan& scan, const auto& path) {
                 map.insert(input.lifted(input.measured(scan.cloud)), computed_from, path);
               });
  read_all(input, poses, "dense map, seen through", interrupt,
           [&](const RecordedScan& scan, const auto& path) {
             const OrganizedCloud cloud = input.measured(scan.cloud);
             const bool all_measured = input.upsampler || !computed_from;
             map.see_through(all_measured ? cloud : select_rows(cloud, *computed_from), path);
           });
  DenseMapRun run;
  run.points = map.points();
  run.voxel_m = choice.voxel_m;
  run.scans = inserted.scans;
  run.scans_left_out = inserted.without_pose;
  run.not_understood = inserted.left_out;
  run.is_full = map.is_full();
  run.end_message = inserted.end_message;
  run.wall_s = seconds_since(start);
  return run;
}

}  // namespace hqslam::tools
