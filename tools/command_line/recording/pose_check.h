#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hqslam/pipeline/scan_poses.h"
#include "hqslam/recordings/recording.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

/// Given poses beside those of SLAM.
struct PoseCheck {
  /// The median over stretches of a metre of
  ///   |t_given - t_slam| / |t_slam|,
  /// the translations in the sensor's frame at the beginning of a stretch. The first twenty and
  /// more are compared, until the drive has turned by 0.8 rad. Nothing if SLAM follows fewer than
  /// five in the first 300 scans.
  std::optional<double> motion_difference;
  /// The sum over the same stretches of the angle between both rotations over that of the turns.
  /// Nothing if they turn by less than 0.8 rad.
  std::optional<double> turn_difference;
  /// Whether what is up for SLAM, which stands on the ground, is down in the frame of the poses.
  bool is_upside_down = false;
};
PoseCheck check_poses(const pipeline::ScanPoses& poses, recordings::Recording& recording,
                      const InterruptGuard& interrupt);

/// Prints one line to stderr if poses are not the scans': those of another drive, time, scale or
/// frame (a camera's, z downwards), of another order of a quaternion's numbers. path: their file;
/// without one there is nothing to check, and the recording is not opened.
void warn_of_wrong_poses(
    const pipeline::ScanPoses& poses, const std::string& path, const InterruptGuard& interrupt,
    const std::function<std::unique_ptr<recordings::Recording>()>& open_recording);

}  // namespace hqslam::tools
