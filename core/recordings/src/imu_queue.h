#pragma once

#include <deque>
#include <vector>

#include "hqslam/core/imu_sample.h"
#include "hqslam/recordings/scan_assembler.h"

namespace hqslam::recordings {

/// Inertial samples that wait for their scan; its memory is bounded.
class ImuQueue {
 public:
  /// A sample, its stamp by the sensor's clock.
  void add(const ImuSample& sample);
  /// Those up to the end of a scan by that clock, offset_s added to their stamps. What is ten
  /// seconds away is of a clock that was set, or of an outage, and is left out.
  std::vector<ImuSample> take(double end_s, double offset_s);
  /// Something that was no sample.
  void add_damaged() { ++counts_.left_out; }
  const ImuCounts& counts() const { return counts_; }

 private:
  std::deque<ImuSample> waiting_;
  double last_s_ = 0.0;
  ImuCounts counts_;
};

}  // namespace hqslam::recordings
