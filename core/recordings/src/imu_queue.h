#pragma once

#include <deque>
#include <vector>

#include "hqslam/core/imu_sample.h"
#include "hqslam/recordings/packet.h"

namespace hqslam::recordings {

/// Inertial samples that wait for their scan; its memory is bounded.
class ImuQueue {
 public:
  /// A sample, its stamp by the sensor's clock.
  void add(const ImuSample& sample);
  /// The samples up to the end of a scan by that clock, offset_s added to their stamps. Samples ten
  /// seconds away are left out: the clock was set, or the sensor was silent.
  std::vector<ImuSample> take(double end_s, double offset_s);
  /// Counts a message that holds no sample.
  void add_damaged() { ++counts_.left_out; }
  const ImuCounts& counts() const { return counts_; }

 private:
  std::deque<ImuSample> waiting_;
  double last_s_ = 0.0;
  ImuCounts counts_;
};

}  // namespace hqslam::recordings
