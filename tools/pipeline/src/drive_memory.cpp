#include "hqslam/pipeline/drive_memory.h"

#include <algorithm>
#include <utility>

#include "hqslam/core/projection.h"

namespace hqslam::pipeline {
namespace {

/// The path during the next scan if the motion between the last two goes on.
slam::SensorPath expected_path(const Trajectory& before, double stamp_s) {
  const StampedPose& last = before.back();
  if (before.size() < 2) return slam::SensorPath(last.T_map_sensor);
  const StampedPose& earlier = before[before.size() - 2];
  const double step_s = last.stamp_s - earlier.stamp_s;
  if (!(step_s > 0.0 && stamp_s > last.stamp_s)) return slam::SensorPath(last.T_map_sensor);
  const Pose expected =
      interpolate(earlier.T_map_sensor, last.T_map_sensor, 1.0 + (stamp_s - last.stamp_s) / step_s);
  return {{earlier, last, {stamp_s, expected}}, 2};
}

nn::ColumnPoses moved(const Pose& T_memory_map, nn::ColumnPoses poses) {
  for (Pose& pose : poses) pose = T_memory_map * pose;
  return poses;
}

std::optional<nn::ScanMemory> memory_for(const nn::Upsampler* method,
                                         const nn::ScanMemoryOptions& options) {
  if (method == nullptr || !method->has_scan_memory()) return std::nullopt;
  return nn::ScanMemory(method->sensor(), options);
}

}  // namespace

/// Four columns share one pose: within them a car moves a millimetre or two, and finding a pose
/// takes longer than recalling ten points.
nn::ColumnPoses column_poses(const slam::SensorPath& path, const OrganizedCloud& measured,
                             const SensorModel& sensor) {
  if (measured.time_offset_s.empty()) return {path.at(0.0)};
  constexpr int kShared = 4;
  const int first = first_column(measured, select_rows(sensor, *sensor.measured_rows));
  nn::ColumnPoses poses(sensor.columns);
  for (int begin = 0; begin < sensor.columns; begin += kShared) {
    const double middle = (begin + 0.5 * kShared) / sensor.columns - 0.5;
    const Pose pose = path.at(sensor.scan_period_s * middle);
    const int end = std::min(begin + kShared, sensor.columns);
    for (int i = begin; i < end; ++i) poses[(first + i) % sensor.columns] = pose;
  }
  return poses;
}

DriveMemory::DriveMemory(const nn::Upsampler* method) : memory_(memory_for(method, {})) {
  if (memory_) sensor_ = method->sensor();
}

nn::RecalledImage DriveMemory::recall(const OrganizedCloud& measured, const Trajectory& before,
                                      double stamp_s) {
  if (!memory_ || !T_memory_sensor_ || before.empty()) return {};
  const Pose T_memory_map = *T_memory_sensor_ * before.back().T_map_sensor.inverse();
  return memory_->recall(
      range_image(measured),
      moved(T_memory_map, column_poses(expected_path(before, stamp_s), measured, sensor_)));
}

void DriveMemory::insert(const OrganizedCloud& measured, const Trajectory& trajectory,
                         bool is_located) {
  if (!memory_) return;
  if (!is_located) {
    memory_->clear();
    T_memory_sensor_.reset();
    return;
  }
  const StampedPose& last = trajectory.back();
  T_memory_sensor_ =
      T_memory_sensor_ ? orthonormalized(*T_memory_sensor_ *
                                         trajectory[trajectory.size() - 2].T_map_sensor.inverse() *
                                         last.T_map_sensor)
                       : Pose::Identity();
  const Pose T_memory_map = *T_memory_sensor_ * last.T_map_sensor.inverse();
  const slam::SensorPath path(trajectory, trajectory.size() - 1);
  memory_->insert(measured, moved(T_memory_map, column_poses(path, measured, sensor_)),
                  last.stamp_s);
}

LookAheadMemory::LookAheadMemory(const nn::Upsampler* method, const ScanPoses& poses,
                                 bool looks_ahead)
    : memory_(memory_for(method, looks_ahead ? nn::kLookAheadMemory : nn::ScanMemoryOptions{})),
      poses_(poses),
      looks_ahead_(looks_ahead) {
  if (memory_) sensor_ = method->sensor();
}

std::int64_t LookAheadMemory::look_ahead_scans() const {
  return memory_ && looks_ahead_ ? nn::kLookAheadScans : 0;
}

void LookAheadMemory::insert(const OrganizedCloud& measured, std::int64_t scan, double stamp_s) {
  if (!memory_ || !looks_ahead_) return;
  if (const auto poses = poses_of(measured, scan, stamp_s)) {
    memory_->insert(measured, *poses, stamp_s);
  }
}

nn::RecalledImage LookAheadMemory::recall(const OrganizedCloud& measured, std::int64_t scan,
                                          double stamp_s) {
  if (!memory_) return {};
  const auto poses = poses_of(measured, scan, stamp_s);
  ++(poses ? with_pose_ : without_pose_);
  if (!poses) return {};
  nn::RecalledImage recalled = memory_->recall(range_image(measured), *poses, stamp_s);
  if (!looks_ahead_) memory_->insert(measured, *poses, stamp_s);
  return recalled;
}

std::optional<nn::ColumnPoses> LookAheadMemory::poses_of(const OrganizedCloud& measured,
                                                         std::int64_t scan, double stamp_s) const {
  const auto path = poses_.path_of(scan, stamp_s, sensor_.scan_period_s);
  if (!path) return std::nullopt;
  return column_poses(*path, measured, sensor_);
}

}  // namespace hqslam::pipeline
