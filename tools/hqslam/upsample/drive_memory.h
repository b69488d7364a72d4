#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/nn/scan_memory.h"
#include "hqslam/nn/upsampler.h"
#include "hqslam/slam/sensor_path.h"
#include "recording/reading.h"
#include "recording/scan_poses.h"

namespace hqslam::tools {

/// Where the sensor is at each column of a scan, or one pose for a motion-corrected one. sensor:
/// all rows, and which of them are measured.
nn::ColumnPoses column_poses(const slam::SensorPath& path, const OrganizedCloud& measured,
                             const SensorModel& sensor);

/// The scans of a drive so far, for a network with a memory, where SLAM put them. For any other way
/// of upsampling it remembers nothing.
class DriveMemory {
 public:
  /// upsampler: null where nothing is upsampled.
  explicit DriveMemory(const nn::Upsampler* upsampler);

  /// What is recalled in a scan before SLAM has located it: it is expected to move on as it did
  /// between the two scans before. before: SLAM's trajectory up to them.
  nn::RecalledImage recall(const OrganizedCloud& measured, const Trajectory& before,
                           double stamp_s);
  /// SLAM has located the scan, the last of its trajectory, or not: then all is forgotten. Loops
  /// that correct the whole trajectory do not move what is remembered.
  void remember(const OrganizedCloud& measured, const Trajectory& trajectory, bool is_located);

 private:
  std::optional<nn::ScanMemory> memory_;
  SensorModel sensor_;
  /// Of the last scan that was remembered by its place in a trajectory: a frame that no loop moves.
  std::optional<Pose> T_memory_sensor_;
};

/// The same where the poses of the whole drive are known: a scan recalls those before it and after
/// it, as far as their poses are known.
class LookAheadMemory {
 public:
  /// measured: what is measured of a recorded scan. poses: must outlive this. looks_ahead: or else
  /// a scan recalls only those before it.
  LookAheadMemory(const nn::Upsampler* upsampler, const ScanPoses& poses,
                  std::function<OrganizedCloud(const RecordedScan&)> measured,
                  bool looks_ahead = true);

  /// For read_scans: remembers what is read.
  LookAhead look_ahead();
  /// Of every scan that was read.
  nn::RecalledImage recall(const ReadScan& read, const OrganizedCloud& measured);
  /// On stderr, at the end. Throws Error if no scan had a pose. Names of files, for the message.
  void tell_of_scans_without_pose(const std::string& poses, const std::string& recording) const;

 private:
  std::optional<nn::ColumnPoses> poses_of(const ReadScan& read,
                                          const OrganizedCloud& measured) const;

  std::optional<nn::ScanMemory> memory_;
  std::int64_t scans_ = 0;  ///< with a pose, and without one
  std::int64_t scans_without_pose_ = 0;
  SensorModel sensor_;
  const ScanPoses& poses_;
  std::function<OrganizedCloud(const RecordedScan&)> measured_;
  bool looks_ahead_;
};

/// Throws Error where poses are named that nothing looks at. upsampler: null where nothing is
/// upsampled.
void require_memory(const std::string& poses, const nn::Upsampler* upsampler);

}  // namespace hqslam::tools
