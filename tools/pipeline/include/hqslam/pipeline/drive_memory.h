#pragma once

#include <cstdint>
#include <optional>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/nn/scan_memory.h"
#include "hqslam/nn/upsampler.h"
#include "hqslam/pipeline/scan_poses.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::pipeline {

/// The sensor's pose at each column of a scan, or one pose for a motion-corrected scan. sensor: all
/// rows, and which of them are measured.
nn::ColumnPoses column_poses(const slam::SensorPath& path, const OrganizedCloud& measured,
                             const SensorModel& sensor);

/// The earlier scans of a drive, where SLAM located them, for networks with a memory. For other
/// methods it keeps nothing.
class DriveMemory {
 public:
  /// method: nullptr where nothing is upsampled.
  explicit DriveMemory(const nn::Upsampler* method);

  /// What earlier scans measured, seen from a scan that SLAM has not located yet: the motion
  /// between the two scans before is expected to go on. before: SLAM's trajectory up to them.
  nn::RecalledImage recall(const OrganizedCloud& measured, const Trajectory& before,
                           double stamp_s);
  /// Keeps a scan after SLAM has processed it: it is the last of `trajectory`. A scan that was not
  /// located clears the memory. Loops that correct the trajectory do not move what is kept.
  void insert(const OrganizedCloud& measured, const Trajectory& trajectory, bool is_located);

 private:
  std::optional<nn::ScanMemory> memory_;
  SensorModel sensor_;
  /// Pose of the last kept scan in a frame that no loop moves.
  std::optional<Pose> T_memory_sensor_;
};

/// The scans before and after each scan of a drive whose poses are known, for networks with a
/// memory. For other methods it keeps nothing.
///
///   memory.insert(scan i + look_ahead_scans()), then memory.recall(scan i)
class LookAheadMemory {
 public:
  /// method: nullptr where nothing is upsampled. poses: must outlive this. looks_ahead: otherwise
  /// a scan recalls only those before it.
  LookAheadMemory(const nn::Upsampler* method, const ScanPoses& poses, bool looks_ahead = true);

  /// How many scans after one are inserted before it recalls; with 0, insert() does nothing.
  std::int64_t look_ahead_scans() const;
  void insert(const OrganizedCloud& measured, std::int64_t scan, double stamp_s);
  /// What other scans measured, seen from this one; empty where its pose is unknown.
  nn::RecalledImage recall(const OrganizedCloud& measured, std::int64_t scan, double stamp_s);

  /// How many scans recalled with a pose, and without one.
  std::int64_t scans_with_pose() const { return with_pose_; }
  std::int64_t scans_without_pose() const { return without_pose_; }

 private:
  std::optional<nn::ColumnPoses> poses_of(const OrganizedCloud& measured, std::int64_t scan,
                                          double stamp_s) const;

  std::optional<nn::ScanMemory> memory_;
  SensorModel sensor_;
  const ScanPoses& poses_;
  bool looks_ahead_;
  std::int64_t with_pose_ = 0;
  std::int64_t without_pose_ = 0;
};

}  // namespace hqslam::pipeline
