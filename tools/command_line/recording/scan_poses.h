#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hqslam/core/scan_source.h"
#include "hqslam/pipeline/drive_memory.h"
#include "hqslam/pipeline/scan_poses.h"
#include "hqslam/pipeline/upsampler.h"
#include "recording/reading.h"
#include "terminal/terminal.h"

namespace hqslam::tools {

using pipeline::ScanPoses;

/// Help of options for networks with a memory.
inline constexpr const char* kMemoryPosesHelp =
    "Poses of the scans, with which a network with a memory recalls other scans: TUM, matched by "
    "stamp, or KITTI with one pose per scan, such as the trajectory.tum of hqslam run";
/// Help of options that read_scan_poses reads.
inline constexpr const char* kScanPosesHelp =
    "Poses of the scans: TUM, matched by stamp (0.02 s), where scans without a pose are left out; "
    "or KITTI with one pose per scan";
/// The poses of a file; none without a path. A KITTI file must have as many poses as the recording
/// has scans, whose stamps they get: only for it the recording is opened and read. Throws Error.
ScanPoses read_scan_poses(const std::string& path, const InterruptGuard& interrupt,
                          const std::function<std::unique_ptr<ScanSource>()>& open_recording);

/// The Error message where none of `scans` scans has a pose.
std::string no_pose_message(const std::string& poses, std::int64_t scans,
                            const std::string& recording);

/// For read_scans: a memory takes in the scans ahead. Both must outlive what is returned.
LookAhead look_ahead_of(pipeline::LookAheadMemory& memory, const pipeline::Upsampler& upsampler);
/// Throws Error where poses are named and the method has no memory that uses them.
void require_memory(const std::string& poses, bool has_memory);
/// Prints to stderr how many scans had no pose; throws Error if none had one. poses, recording:
/// names of files, for the message.
void report_scans_without_pose(const pipeline::LookAheadMemory& memory, const std::string& poses,
                               const std::string& recording);

}  // namespace hqslam::tools
