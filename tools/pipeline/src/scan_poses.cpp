#include "hqslam/pipeline/scan_poses.h"

#include <algorithm>
#include <cmath>

namespace hqslam::pipeline {
namespace {

/// The pose whose stamp is nearest, nothing if it is too far.
std::optional<std::size_t> pose_at(const Trajectory& trajectory, double stamp_s) {
  const auto first = std::ranges::lower_bound(trajectory, stamp_s - kMaxStampDifference_s, {},
                                              &StampedPose::stamp_s);
  const auto end = std::ranges::upper_bound(
      first, trajectory.end(), stamp_s + kMaxStampDifference_s, {}, &StampedPose::stamp_s);
  const auto off_s = [&](const StampedPose& pose) { return std::abs(pose.stamp_s - stamp_s); };
  const auto nearest = std::ranges::min_element(first, end, {}, off_s);
  if (nearest == end || off_s(*nearest) > kMaxStampDifference_s) return std::nullopt;
  return static_cast<std::size_t>(nearest - trajectory.begin());
}

/// The pose of a scan of the recording, nothing if it has none.
std::optional<std::size_t> pose_of_scan(const std::vector<std::int64_t>& scan_of_pose,
                                        std::int64_t scan) {
  const auto found = std::ranges::lower_bound(scan_of_pose, scan);
  if (found == scan_of_pose.end() || *found != scan) return std::nullopt;
  return static_cast<std::size_t>(found - scan_of_pose.begin());
}

}  // namespace

std::optional<slam::SensorPath> ScanPoses::path_of(std::int64_t scan, double stamp_s,
                                                   double scan_period_s) const {
  const auto pose = scan_of_pose ? pose_of_scan(*scan_of_pose, scan) : pose_at(trajectory, stamp_s);
  if (!pose || (!is_located.empty() && !is_located[*pose])) return std::nullopt;
  const auto is_apart = [&](std::size_t other) {
    return std::abs(trajectory[other].stamp_s - trajectory[*pose].stamp_s) >= 0.5 * scan_period_s;
  };
  std::size_t before = *pose;
  while (before > 0 && knows_next(before - 1) && !is_apart(before)) --before;
  std::size_t after = *pose;
  while (after + 1 < trajectory.size() && knows_next(after) && !is_apart(after)) ++after;
  Trajectory about;
  if (before < *pose) about.push_back(trajectory[before]);
  const std::size_t here = about.size();
  about.push_back(trajectory[*pose]);
  if (after > *pose) about.push_back(trajectory[after]);
  if (!scan_of_pose && stamp_s != about[here].stamp_s) {
    const slam::SensorPath nearby(about, here);
    about[here] = {stamp_s, nearby.at(stamp_s - about[here].stamp_s)};
  }
  return slam::SensorPath(about, here);
}

}  // namespace hqslam::pipeline
