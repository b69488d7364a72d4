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

/// The scans of a drive one after the other, and what each recalls of those before, or with
/// look_ahead of those before and after it, by poses as SLAM may have them.
class Recollection {
 public:
  /// rows: that are measured.
  Recollection(const SensorModel& sensor, RowSelection rows, bool look_ahead, std::uint64_t seed);

  /// A scan whose image is wanted with M and W^2 below it (finished); before remember(scan).
  void want(const sim::SimulatedScan& scan);
  /// Its measured rows.
  void remember(const sim::SimulatedScan& scan);
  /// The first scan that is wanted, once all that it recalls are remembered; is_last: none comes.
  std::optional<RangeImage> finished(bool is_last = false);

 private:
  struct Wanted {
    sim::SimulatedScan scan;
    int later = 0;  ///< scans that are remembered since
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
