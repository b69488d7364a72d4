#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::pipeline {

/// Two stamps that differ by at most this much are taken for those of one scan.
inline constexpr double kMaxStampDifference_s = 0.02;

/// Poses of the scans of a recording.
struct ScanPoses {
  Trajectory trajectory;
  /// Per pose, whether it is known, in one frame with the others; empty: all are.
  std::vector<bool> is_located;
  /// Per pose, whether the relative pose to the next is known; empty: all are.
  std::vector<bool> is_next_known;
  /// Per pose, the index of its scan in the recording, from 0, rising; nothing: stamps are matched.
  std::optional<std::vector<std::int64_t>> scan_of_pose;

  /// The sensor's path during a scan of the recording, by the scan's index or its stamp; nothing
  /// where it is unknown. From its pose at the stamp the sensor moves evenly to the poses that are
  /// at least half a period away: steps between closer ones would be mostly noise.
  std::optional<slam::SensorPath> path_of(std::int64_t scan, double stamp_s,
                                          double scan_period_s) const;

 private:
  bool knows_next(std::size_t pose) const {
    return pose >= is_next_known.size() || is_next_known[pose];
  }
};

}  // namespace hqslam::pipeline
