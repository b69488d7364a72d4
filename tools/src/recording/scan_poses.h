#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::tools {

/// Where the scans of a recording were taken.
struct ScanPoses {
  Trajectory trajectory;
  /// Per pose, whether it is known, and in one frame with the others; empty: all are.
  std::vector<bool> is_located;
  /// Per pose, whether something is known of the way to the next; empty: of all.
  std::vector<bool> is_way_known;
  /// Of which scan of the recording each pose is, counted from 0 and rising; nothing: stamps tell.
  std::optional<std::vector<std::int64_t>> scan_of_pose;

  /// The way from a pose to the next.
  bool knows_way(std::size_t pose) const {
    return pose >= is_way_known.size() || is_way_known[pose];
  }
  /// The sensor's path during a scan of the recording, by its number or its stamp; nothing where
  /// that is not known.
  std::optional<slam::SensorPath> path_of(std::int64_t scan, double stamp_s) const;
};

/// The same for networks with a memory.
inline constexpr const char* kMemoryPosesHelp =
    "For networks with a memory: where the scans were taken (TUM, matched by stamp, or KITTI with "
    "one pose per scan), such as the trajectory.tum of hqslam run; without it nothing is "
    "remembered";
/// How options say what `read_scan_poses` takes.
inline constexpr const char* kScanPosesHelp =
    "Where the scans were taken: TUM, matched by stamp (0.02 s), scans without a pose are left "
    "out; or KITTI with one pose per scan";
/// How messages say what to do where no scan has one.
inline constexpr const char* kGiveScanPoses =
    "give poses with the stamps of the scans, as the trajectory.tum of hqslam run with the same "
    "options has them";
/// The poses of a file, none without a path; KITTI's must be as many as the recording has scans,
/// which is asked only then. Throws Error.
ScanPoses read_scan_poses(const std::string& path,
                          const std::function<std::int64_t()>& scans_in_recording);

}  // namespace hqslam::tools
