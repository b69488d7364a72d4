#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <random>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/scan_memory.h"
#include "hqslam/sim/drive.h"

namespace hqslam::tools {

/// Scans of a drive with what each recalls of the scans before it and, with look_ahead, of those
/// after it, placed by poses with the errors of SLAM's.
class DriveRecall {
 public:
  /// rows: the measured rows.
  DriveRecall(const SensorModel& sensor, RowSelection rows, bool look_ahead, std::uint64_t seed);

  /// Asks finished() for the image of a scan with its recall; to be called before add(scan).
  void want(const sim::SimulatedScan& scan);
  /// Adds the measured rows of a scan to the memory.
  void add(const sim::SimulatedScan& scan);
  /// The image of the first scan that is wanted, with M and W^2 below it, once all scans that
  /// it recalls were added. is_last: no more scans follow.
  std::optional<RangeImage> finished(bool is_last = false);

 private:
  struct Wanted {
    sim::SimulatedScan scan;
    int later = 0;  ///< number of later scans that were added
  };
  RangeImage with_recalled(const sim::SimulatedScan& scan);

  RowSelection rows_;
  int look_ahead_scans_;
  SensorModel sensor_;  ///< the measured rows alone
  nn::ScanMemory memory_;
  std::mt19937_64 random_;
  std::deque<Wanted> wanted_;
};

}  // namespace hqslam::tools
