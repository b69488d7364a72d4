#pragma once

#include <string>
#include <vector>

#include "hqslam/core/point_times.h"
#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// Names of fields that mean the same in every kind of file.
inline constexpr const char* kRingNames[] = {"ring", "channel"};
inline constexpr const char* kTimeNames[] = {"t", "time", "timestamp", "time_stamp", "offset_time"};

/// The points of a file with their rings and times as the file has them.
struct RawPoints {
  Scan scan;
  std::vector<double> ring;  ///< per point; empty if the file has none
  std::string ring_name;
  PointTimeField time;  ///< per point; empty if the file has none

  /// Keeps the point if it is finite and not at the origin; otherwise counts it. Returns whether.
  bool add(double x_m, double y_m, double z_m);
};

/// Rings to rows, times to offsets. `sensor` may be nullptr: then rows are left empty. Throws
/// Error.
Scan scan_of(RawPoints points, const SensorModel* sensor, const std::string& path);

}  // namespace hqslam
