#include "recording/scan_poses.h"

#include <fmt/format.h>

#include "hqslam/core/error.h"
#include "recording/reference.h"

namespace hqslam::tools {
ScanPoses read_scan_poses(const std::string& path, const InterruptGuard& interrupt,
                          const std::function<std::unique_ptr<ScanSource>()>& open_recording) {
  if (path.empty()) return {};
  const TrajectoryFile file = read_trajectory_file(path);
  if (file.has_stamps) return {file.poses, {}, {}, std::nullopt};
  ScanPoses poses;
  poses.scan_of_pose.emplace();
  std::int64_t scans = 0;
  Reading reading;
  const auto source = open_recording();
  read_scans(*source, interrupt, reading, [&](const ReadScan& read) {
    const auto scan = static_cast<std::size_t>(read.index);
    if (scan < file.poses.size()) {
      poses.trajectory.push_back({read.scan.stamp_s, file.poses[scan].T_map_sensor});
      poses.scan_of_pose->push_back(read.index);
    }
    ++scans;
    return true;
  });
  scans += reading.left_out.scans;
  if (std::ssize(file.poses) != scans && reading.end == ReadingEnd::kComplete) {
    throw Error(
        "{}: has {} poses without stamps, but the recording has {} scans; give one pose per scan "
        "or a TUM file",
        path, file.poses.size(), scans);
  }
  return poses;
}

std::string no_pose_message(const std::string& poses, std::int64_t scans,
                            const std::string& recording) {
  return fmt::format(
      "{}: none of its poses is within {} s of one of {} scans of {}; give poses with the stamps "
      "of the scans, as the trajectory.tum of hqslam run with the same options has them",
      poses, kMaxStampDifference_s, scans, recording);
}

LookAhead look_ahead_of(pipeline::LookAheadMemory& memory, const pipeline::Upsampler& upsampler) {
  if (memory.look_ahead_scans() == 0) return {};
  return {memory.look_ahead_scans(), [&](const ReadScan& read) {
            memory.insert(upsampler.measured(read.scan.cloud), read.index, read.scan.stamp_s);
          }};
}

void require_memory(const std::string& poses, bool has_memory) {
  if (poses.empty() || has_memory) return;
  throw Error(
      "--poses {}: expected weights with a memory, which alone use poses, found none; leave "
      "it out",
      poses);
}

void report_scans_without_pose(const pipeline::LookAheadMemory& memory, const std::string& poses,
                               const std::string& recording) {
  const std::int64_t without = memory.scans_without_pose();
  if (poses.empty() || without == 0) return;
  if (memory.scans_with_pose() == 0) throw Error(no_pose_message(poses, without, recording));
  to_stderr("hqslam: {}: {} of {} scans have no pose; they recalled no other scan\n", poses,
            without, without + memory.scans_with_pose());
}

}  // namespace hqslam::tools
