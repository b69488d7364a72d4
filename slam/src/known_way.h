#pragma once

#include <cstddef>

namespace hqslam::slam {

/// What is known of the way from the last scan that was located in the map to the scan at hand.
class KnownWay {
 public:
  /// Whether a scan stands elsewhere than the last one that was located. In: the share of what
  /// stands in it that fits the map (MappingResult::inlier_ratio).
  bool leads_elsewhere(double inlier_ratio) const {
    return inlier_ratio < kLeastShareOfLast * inlier_ratio_;
  }

  void located(double inlier_ratio) {
    inlier_ratio_ = inlier_ratio;
    unlocated_scans_ = 0;
    is_measured_ = true;
  }

  /// In: whether the odometry measured the way to the scan.
  void not_located(bool is_measured) {
    ++unlocated_scans_;
    is_measured_ = is_measured_ && is_measured;
  }

  /// How many scans in a row were not located.
  std::size_t unlocated_scans() const { return unlocated_scans_; }
  /// The sensor was carried away, or has drifted too far: the map is to go on from where it is
  /// believed to be.
  bool is_lost() const { return unlocated_scans_ > kMaxUnlocatedScans; }
  /// Whether the odometry measured all of the way.
  bool is_measured() const { return is_measured_; }

 private:
  /// From scan to scan the share falls to 0.83 at the most on simulated drives of all kinds, and
  /// to 0.44 in another street.
  static constexpr double kLeastShareOfLast = 0.6;
  static constexpr std::size_t kMaxUnlocatedScans = 5;

  double inlier_ratio_ = 0.0;  ///< of the last scan that was located
  std::size_t unlocated_scans_ = 0;
  bool is_measured_ = true;
};

}  // namespace hqslam::slam
