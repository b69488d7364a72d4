#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/slam/sensor_path.h"
#include "terminal/terminal.h"

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
  /// that is not known. From its pose at the stamp it moves evenly to the poses that are at least
  /// half a period away: steps between closer ones would be mostly noise.
  std::optional<slam::SensorPath> path_of(std::int64_t scan, double stamp_s,
                                          double scan_period_s) const;
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
/// The poses of a file, none without a path. KITTI's must be as many as the recording has scans,
/// and get their stamps: only then it is opened, and read. Throws Error.
ScanPoses read_scan_poses(const std::string& path, const InterruptGuard& interrupt,
                          const std::function<std::unique_ptr<ScanSource>()>& open_recording);

/// What to say where no pose belongs to any of so many scans.
std::string no_pose_message(const std::string& poses, std::int64_t scans,
                            const std::string& recording);

}  // namespace hqslam::tools
