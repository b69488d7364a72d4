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
  /// The median over stretches of a metre, of which the first twenty are compared, of
  ///   |t_given - t_slam| / |t_slam|,
  /// the translations in the sensor's frame at the beginning of a stretch. Nothing if SLAM follows
  /// fewer than five in the first 300 scans.
  std::optional<double> motion_difference;
  /// Whether what is up for SLAM, which stands on the ground, is down in the frame of the poses.
  bool is_upside_down = false;
};
PoseCheck check_poses(const pipeline::ScanPoses& poses, recordings::Recording& recording,
                      const InterruptGuard& interrupt);

/// Prints one line to stderr if poses are not the scans': those of another drive, of another frame
/// (a camera's, z downwards), of another order of a quaternion's numbers. path: their file; without
/// one there is nothing to check, and the recording is not opened.
void warn_of_wrong_poses(
    const pipeline::ScanPoses& poses, const std::string& path, const InterruptGuard& interrupt,
    const std::function<std::unique_ptr<recordings::Recording>()>& open_recording);

}  // namespace hqslam::tools
