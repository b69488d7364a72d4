#pragma once

#include <memory>
#include <string>

#include "hqslam/core/scan_source.h"
#include "hqslam/recordings/scan_assembler.h"
#include "recording_file.h"

namespace hqslam::recordings {

/// A recording as a source of scans, and what was found out about it.
struct Opened {
  std::unique_ptr<ScanSource> source;
  RecordingInfo info;
};

/// Scans of a stream of Velodyne packets. Throws Error.
Opened open_velodyne(std::shared_ptr<const RecordingFile> file, const Stream& stream,
                     const std::string& path, const OpenOptions& options);

/// Scans of a stream of an Ouster's lidar packets. Throws Error.
Opened open_ouster(std::shared_ptr<const RecordingFile> file, const Stream& stream,
                   const std::string& path, const OpenOptions& options);

/// Scans of a topic of sensor_msgs/PointCloud2. Throws Error.
Opened open_clouds(std::shared_ptr<const RecordingFile> file, const Stream& stream,
                   const std::string& path, const OpenOptions& options);

/// The scans that the assembler makes of a stream's packets; `info` says how many there are.
std::unique_ptr<ScanSource> packet_scan_source(std::shared_ptr<const RecordingFile> file,
                                               const Stream& stream, const RecordingInfo& info,
                                               std::unique_ptr<ScanAssembler> assembler);

/// "3 packets were lost, 1 came late or twice"; empty if all is well.
std::string packet_complaint(const PacketCounts& counts, std::int64_t lost_scans);

}  // namespace hqslam::recordings
