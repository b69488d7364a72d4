#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/imu_sample.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/projection.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

/// One scan of a recording, ready for SLAM or upsampling.
struct RecordedScan {
  std::string name;  ///< the file, or the stack and the index in it
  double stamp_s = 0.0;
  OrganizedCloud cloud;
  std::int64_t invalid_points = 0;  ///< not finite or at the origin: dropped
  ProjectionCounts counts;
  std::vector<ImuSample> imu;  ///< since the scan before, up to the end of this one
};

/// A recording read once, scan by scan; never more than its first few scans in memory.
class ScanSource {
 public:
  virtual ~ScanSource() = default;
  virtual const SensorModel& sensor() const = 0;
  /// Number of scans; nothing where it is known only after the last one was read.
  virtual std::optional<std::int64_t> size() const = 0;
  /// How much of the recording was read, 0 to 1.
  virtual double read_share() const = 0;
  /// Whether its stamps are its own; otherwise they are counted in the sensor's periods from 0 s.
  virtual bool has_stamps() const = 0;
  /// The next scan, or nothing at the end. Throws ScanError for a scan that cannot be understood,
  /// after which the next one can be asked for, and Error where the recording cannot be read on.
  virtual std::optional<RecordedScan> next() = 0;
  /// Warnings for users of the recording, a line each; complete when all scans were read.
  virtual std::vector<std::string> warnings() const { return {}; }
};

}  // namespace hqslam
