#pragma once

#include <optional>
#include <string>

#include "hqslam/core/point_times.h"
#include "hqslam/core/scan.h"
#include "recording_file.h"

namespace hqslam::recordings {

/// A sensor_msgs/PointCloud2 with what matters of it.
struct PointCloudMessage {
  std::int64_t stamp_ns = 0;  ///< of its header
  Scan scan;                  ///< points alone; not finite ones and those at the origin are counted
  std::vector<double> ring;   ///< per point; empty if there is no such field
  std::string ring_name;
  PointTimeField time;  ///< per point; empty if there is no such field
};

/// The stamp of the header alone. Throws Error.
std::int64_t point_cloud_stamp_ns(const Message& message);

/// Fields x y z, ring or channel, and t, time, timestamp, time_stamp or offset_time; of any of the
/// eight types, in any order. Throws Error for a message that is damaged or has no coordinates.
PointCloudMessage read_point_cloud(const Message& message);

}  // namespace hqslam::recordings
