#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "hqslam/core/organized_cloud.h"

namespace hqslam::tools {

/// A scan as SLAM saw it, in the sensor's frame, thinned to some columns of it.
struct KeptScan {
  struct Point {
    Eigen::Vector3f point_m;
    float time_offset_s;
    int row;
  };
  std::size_t pose = 0;  ///< of the run's trajectory
  std::vector<Point> points;
};

/// Some scans of a drive, for the report, evenly over it however long it gets.
class KeptScans {
 public:
  static constexpr std::size_t kMost = 48;

  /// The cloud of each pose in turn.
  void offer(std::size_t pose, const OrganizedCloud& cloud) {
    if (pose % every_ != 0) return;
    KeptScan& scan = scans_.emplace_back(KeptScan{pose, {}});
    const int step = std::max(1, cloud.rows * cloud.columns / kMostPixels);
    for (int column = 0; column < cloud.columns; column += step) {
      for (int row = 0; row < cloud.rows; ++row) {
        const std::size_t pixel = cloud.index(row, column);
        if (!(cloud.range_m[pixel] > 0.0F)) continue;
        const float after_s = cloud.time_offset_s.empty() ? 0.0F : cloud.time_offset_s[pixel];
        scan.points.push_back({cloud.points_m[pixel], after_s, row});
      }
    }
    if (scans_.size() <= kMost) return;
    every_ *= 2;
    std::erase_if(scans_, [&](const KeptScan& kept) { return kept.pose % every_ != 0; });
  }
  std::vector<KeptScan> take() { return std::move(scans_); }

 private:
  static constexpr int kMostPixels = 1 << 15;
  std::size_t every_ = 1;
  std::vector<KeptScan> scans_;
};

}  // namespace hqslam::tools
