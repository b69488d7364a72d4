#include "recording/scan_poses.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hqslam/core/error.h"
#include "recording/reference.h"

namespace hqslam::tools {
namespace {

/// The pose whose stamp is nearest, nothing if it is too far.
std::optional<std::size_t> pose_at(const Trajectory& trajectory, double stamp_s) {
  const auto later =
      std::lower_bound(trajectory.begin(), trajectory.end(), stamp_s - kMaxStampDifference_s,
                       [](const StampedPose& a, double limit_s) { return a.stamp_s < limit_s; });
  const auto nearest =
      std::min_element(later,
                       std::find_if(later, trajectory.end(),
                                    [&](const StampedPose& candidate) {
                                      return candidate.stamp_s > stamp_s + kMaxStampDifference_s;
                                    }),
                       [&](const StampedPose& a, const StampedPose& b) {
                         return std::abs(a.stamp_s - stamp_s) < std::abs(b.stamp_s - stamp_s);
                       });
  const bool is_near =
      nearest != trajectory.end() && std::abs(nearest->stamp_s - stamp_s) <= kMaxStampDifference_s;
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

}  // namespace

std::optional<slam::SensorPath> ScanPoses::path_of(std::int64_t scan, double stamp_s) const {
  const auto pose = scan_of_pose ? pose_of_scan(*scan_of_pose, scan) : pose_at(trajectory, stamp_s);
  if (!pose || (!is_located.empty() && !is_located[*pose])) return std::nullopt;
  return slam::SensorPath(trajectory, *pose, {knows_way(*pose - 1), knows_way(*pose)});
}

ScanPoses read_scan_poses(const std::string& path,
                          const std::function<std::int64_t()>& scans_in_recording) {
  if (path.empty()) return {};
  const TrajectoryFile file = read_trajectory_file(path);
  if (file.has_stamps) return {file.poses, {}, {}, std::nullopt};
  const std::int64_t scans = scans_in_recording();
  if (std::ssize(file.poses) != scans) {
    throw Error(
        "{}: has {} poses without stamps, but the recording has {} scans; give one pose per scan "
        "or a TUM file",
        path, file.poses.size(), scans);
  }
  std::vector<std::int64_t> every_scan(file.poses.size());
  std::iota(every_scan.begin(), every_scan.end(), 0);
  return {file.poses, {}, {}, std::move(every_scan)};
}

}  // namespace hqslam::tools
