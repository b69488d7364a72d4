#include "upsample/drive_memory.h"

#include <algorithm>
#include <utility>

#include "hqslam/core/error.h"
#include "hqslam/core/projection.h"
#include "terminal/terminal.h"

namespace hqslam::tools {
namespace {

/// The path of a scan that comes, if the motion goes on as it was.
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

/// As seen from another frame.
nn::ColumnPoses moved(const Pose& T_memory_map, nn::ColumnPoses poses) {
  for (Pose& pose : poses) pose = T_memory_map * pose;
  return poses;
}

}  // namespace

DriveMemory::DriveMemory(const nn::Upsampler* upsampler) {
  if (upsampler == nullptr || !upsampler->has_scan_memory()) return;
  sensor_ = upsampler->sensor();
  memory_.emplace(sensor_);
}

nn::RecalledImage DriveMemory::recall(const OrganizedCloud& measured, const Trajectory& before,
                                      double stamp_s) {
  if (!memory_ || !T_memory_sensor_ || before.empty()) return {};
  const Pose T_memory_map = *T_memory_sensor_ * before.back().T_map_sensor.inverse();
  return memory_->recall(
      range_image(measured),
      moved(T_memory_map, column_poses(expected_path(before, stamp_s), measured, sensor_)));
}

void DriveMemory::remember(const OrganizedCloud& measured, const Trajectory& trajectory,
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

/// Four columns share one: within them a car moves a millimetre or two, and to find a pose takes
/// longer than to look for ten points.
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

LookAheadMemory::LookAheadMemory(const nn::Upsampler* upsampler, const ScanPoses& poses,
                                 std::function<OrganizedCloud(const RecordedScan&)> measured,
                                 bool looks_ahead)
    : poses_(poses), measured_(std::move(measured)), looks_ahead_(looks_ahead) {
  if (upsampler == nullptr || !upsampler->has_scan_memory()) return;
  sensor_ = upsampler->sensor();
  memory_.emplace(sensor_, looks_ahead ? nn::kLookAheadMemory : nn::ScanMemoryOptions{});
}

LookAhead LookAheadMemory::look_ahead() {
  if (!memory_ || !looks_ahead_) return {};
  return {nn::kLookAheadScans, [this](const ReadScan& read) {
            const OrganizedCloud measured = measured_(read.scan);
            if (const auto poses = poses_of(read, measured)) {
              memory_->insert(measured, *poses, read.scan.stamp_s);
            }
          }};
}

nn::RecalledImage LookAheadMemory::recall(const ReadScan& read, const OrganizedCloud& measured) {
  if (!memory_) return {};
  const auto poses = poses_of(read, measured);
  ++(poses ? scans_ : scans_without_pose_);
  if (!poses) return {};
  nn::RecalledImage recalled = memory_->recall(range_image(measured), *poses, read.scan.stamp_s);
  if (!looks_ahead_) memory_->insert(measured, *poses, read.scan.stamp_s);
  return recalled;
}

std::optional<nn::ColumnPoses> LookAheadMemory::poses_of(const ReadScan& read,
                                                         const OrganizedCloud& measured) const {
  const auto path = poses_.path_of(read.index, read.scan.stamp_s, sensor_.scan_period_s);
  if (!path) return std::nullopt;
  return column_poses(*path, measured, sensor_);
}

void LookAheadMemory::tell_of_scans_without_pose(const std::string& poses,
                                                 const std::string& recording) const {
  if (poses.empty() || scans_without_pose_ == 0) return;
  if (scans_ == 0) throw Error(no_pose_message(poses, scans_without_pose_, recording));
  to_stderr("hqslam: {}: {} of {} scans have no pose; nothing was recalled in them\n", poses,
            scans_without_pose_, scans_ + scans_without_pose_);
}

void require_memory(const std::string& poses, const nn::Upsampler* upsampler) {
  if (poses.empty() || (upsampler != nullptr && upsampler->has_scan_memory())) return;
  throw Error("--poses {}: only weights with a memory look at poses, found none; leave it out",
              poses);
}

}  // namespace hqslam::tools
