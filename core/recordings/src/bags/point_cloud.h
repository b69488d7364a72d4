#pragma once

#include <string>

#include "hqslam/core/point_fields.h"
#include "recording_file.h"

namespace hqslam::recordings {

/// The stamp of the header alone; where it was never set, the time of recording. Throws Error.
double point_cloud_stamp_s(const Message& message);

/// The points of a sensor_msgs/PointCloud2. Fields as point_fields() finds them, of any of the
/// eight types, in any order. `source` stands for the message in messages. Throws Error for a
/// message that is damaged or has no coordinates.
RawPoints read_point_cloud(const Message& message, const std::string& source);

}  // namespace hqslam::recordings
