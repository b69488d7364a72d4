#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "hqslam/core/organized_cloud.h"

namespace hqslam::slam {

/// A descriptor of the surroundings of a scan, for place recognition.
///
/// The plane about the sensor is cut into rings and sectors; each bin holds the height of its
/// highest point, 0 if it has none. A rotation of the sensor shifts the columns. Source: Kim & Kim,
/// Scan Context, IROS 2018.
struct ScanContext {
  // As in the paper.
  static constexpr int kRings = 20;
  static constexpr int kSectors = 60;
  static constexpr double kMaxRange_m = 80.0;

  /// Rings x sectors, each sector scaled to unit length, or zero without returns.
  Eigen::Matrix<float, kRings, kSectors, Eigen::DontAlign> unit_sectors;
  std::array<bool, kSectors> has_returns{};
};
ScanContext scan_context(const OrganizedCloud& cloud);

/// Contexts of a scan that is compared with other places: from its own position and from the lanes
/// beside, 4 m to its left and right, since a vehicle returns in another lane. Source: the root
/// shifts of the paper's section III-D.
std::vector<ScanContext> scan_contexts_from_lanes(const OrganizedCloud& cloud);

/// The distance of two contexts and the rotation of the sensor between them.
struct ScanContextMatch {
  double distance = 1.0;  ///< 0: identical, 1: nothing in common
  double yaw_rad = 0.0;   ///< of the other scan's sensor in the frame of the first one's
};

/// The best match over all rotations within max_yaw_error_rad of the expected one.
///
/// For each rotation the distance is 1 - mean over sectors of the cosine between the two scans'
/// bins. Differs from the paper: sectors with returns in one scan only count as different;
/// rotations that the estimated poses exclude are not tried, which also makes a search tree over
/// ring keys needless.
ScanContextMatch compare(const ScanContext& first, const ScanContext& other,
                         double expected_yaw_rad, double max_yaw_error_rad);

}  // namespace hqslam::slam
