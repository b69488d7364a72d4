#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "hqslam/core/organized_cloud.h"

namespace hqslam::slam {

/// What the surroundings look like from where a scan was taken, for recognising the place.
///
/// The plane about the sensor is cut into rings and sectors; each bin holds how high its highest
/// point reaches, 0 if it has none. A turn of the sensor turns the columns. Source: Kim & Kim, Scan
/// Context, IROS 2018.
struct ScanContext {
  static constexpr int kRings = 20;
  static constexpr int kSectors = 60;
  static constexpr double kMaxRange_m = 80.0;

  /// Rings x sectors, each sector scaled to unit length, or all zero where nothing was seen.
  Eigen::Matrix<float, kRings, kSectors> unit_sectors;
  std::array<bool, kSectors> seen{};
};
ScanContext scan_context(const OrganizedCloud& cloud);

/// Contexts of a scan that is looked for at other places: from where it was taken, and as if from
/// the lanes beside, 4 m to its left and right: who comes back the other way seldom passes a place
/// less than a lane away. Source: the root shifts of the paper's section III-D.
std::vector<ScanContext> scan_contexts_from_lanes(const OrganizedCloud& cloud);

/// How well two scans look alike, and by how much the sensor had turned between them.
struct ScanContextMatch {
  double distance = 1.0;  ///< 0: the same, 1: nothing in common
  double yaw_rad = 0.0;   ///< of the other scan's sensor in the frame of the first one's
};

/// The best match over all turns within max_yaw_error_rad of what is expected.
///
/// For each turn the distance is 1 - mean over sectors of the cosine between the two scans' bins.
/// Differs from the paper: sectors that one of the scans did not see count as different if the
/// other did; turns that the estimated poses rule out are not tried, which also makes a search tree
/// over ring keys needless.
ScanContextMatch compare(const ScanContext& first, const ScanContext& other,
                         double expected_yaw_rad, double max_yaw_error_rad);

}  // namespace hqslam::slam
