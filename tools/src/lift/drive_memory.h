#pragma once

#include <optional>
#include <string>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/nn/scan_memory.h"
#include "hqslam/nn/upsampler.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::tools {

/// The scans of a drive so far, for a network with a memory, where SLAM or a file of poses put
/// them. For any other way of lifting it remembers nothing.
class DriveMemory {
 public:
  /// upsampler: null where nothing is lifted.
  explicit DriveMemory(const nn::Upsampler* upsampler);

  /// What is recalled in a scan whose path is known, which is then remembered; of one whose path is
  /// not known nothing is either.
  nn::RecalledImage recall_and_remember(const OrganizedCloud& measured,
                                        const std::optional<slam::SensorPath>& path,
                                        double stamp_s);

  /// The same before SLAM has located the scan: it is expected to move on as it did between the two
  /// scans before. before: SLAM's trajectory up to them.
  nn::RecalledImage recall(const OrganizedCloud& measured, const Trajectory& before,
                           double stamp_s);
  /// SLAM has located the scan, the last of its trajectory, or not: then all is forgotten. Loops
  /// that correct the whole trajectory do not move what is remembered.
  void remember(const OrganizedCloud& measured, const Trajectory& trajectory, bool is_located);

 private:
  nn::ColumnPoses column_poses(const slam::SensorPath& path, const OrganizedCloud& cloud) const;

  std::optional<nn::ScanMemory> memory_;
  SensorModel sensor_;
  /// Of the last scan that was remembered by its place in a trajectory: a frame that no loop moves.
  std::optional<Pose> T_memory_sensor_;
};

/// Throws Error where poses are named that nothing looks at. upsampler: null where nothing is
/// lifted.
void require_memory(const std::string& poses, const nn::Upsampler* upsampler);

}  // namespace hqslam::tools
