#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "hqslam/core/organized_cloud.h"

namespace hqslam::tools {

/// The range image of a scan as SLAM saw it, every n-th column of it.
struct KeptScan {
  std::size_t pose = 0;              ///< of the run's trajectory
  std::vector<std::uint16_t> range;  ///< rows x columns in steps of kRangeStep_m; 0: no return
  std::vector<float> time_offset_s;  ///< of the first return of each column; NaN: not known
};

/// The scans of a drive for the report: all of them, with as many columns as a screen, as long as
/// these have kMostPixels pixels. Then half of the columns go, again and again, and where few are
/// left half of the scans, so that those that stay are evenly over the drive.
class KeptScans {
 public:
  static constexpr std::size_t kMostPixels = std::size_t{1} << 24U;
  static constexpr int kManyColumns = 1024;
  static constexpr int kFewColumns = 300;

  /// The cloud of each pose in turn.
  void offer(std::size_t pose, const OrganizedCloud& cloud) {
    if (pose % every_ != 0) return;
    if (pose == 0) column_step_ = std::max(1, (cloud.columns + kManyColumns / 2) / kManyColumns);
    scans_.push_back(thinned(pose, cloud));
    while (scans_.size() > 1 && scans_.size() * scans_.back().range.size() > kMostPixels) thin();
  }
  std::vector<KeptScan> take() { return std::move(scans_); }

 private:
  KeptScan thinned(std::size_t pose, const OrganizedCloud& cloud) const;
  void thin();

  std::size_t every_ = 1;
  int column_step_ = 1;
  std::vector<KeptScan> scans_;
};

}  // namespace hqslam::tools
