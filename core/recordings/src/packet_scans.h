#pragma once

#include <memory>
#include <string>
#include <vector>

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

/// Goes once through all packets of a stream, to say in `info` how many scans they make and when.
/// decoder: makes scans of type Completed of them; stamp_s(scan): when one was taken.
template <typename Completed, typename Decoder, typename Stamp>
void count_scans(const RecordingFile& file, const Stream& stream, Decoder& decoder,
                 const Stamp& stamp_s, RecordingInfo& info) {
  const auto packets = file.packets(stream);
  std::vector<Completed> scans;
  double last_stamp_s = 0.0;
  const auto take = [&] {
    for (const Completed& scan : scans) {
      last_stamp_s = stamp_s(scan);
      if (info.scans++ == 0) info.first_stamp_s = last_stamp_s;
    }
    scans.clear();
  };
  while (const auto packet = packets->next()) {
    decoder.add(*packet, scans);
    take();
  }
  decoder.finish(scans);
  take();
  info.duration_s = last_stamp_s - info.first_stamp_s + info.sensor.scan_period_s;
  info.packets = decoder.counts();
  if (const std::string text = packets->complaint(); !text.empty()) info.warnings.push_back(text);
}

/// What is to be said of a stream whose scans were counted: throws Error if there are none, warns
/// of packets that were lost.
void judge_counts(const Stream& stream, const std::string& path, RecordingInfo& info);

}  // namespace hqslam::recordings
