#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "hqslam/sim/drive.h"

namespace hqslam::tools {

/// Shares of points within a distance of what they are held against.
struct SharesWithin {
  double at_10_cm = 0.0;
  double at_20_cm = 0.0;
};

/// A map held against the true surface of a simulated drive.
struct MapError {
  std::int64_t points = 0;
  SharesWithin accuracy;      ///< of the map's points: a true surface is so near
  double beyond_30_cm = 0.0;  ///< share of the map's points without a true surface so near
  SharesWithin completeness;  ///< of the true surface's samples: a point of the map is so near
  SharesWithin f1;            ///< harmonic means of the two
};

/// What the sensor of a drive could see along it (DriveSimulator::next_visible), one sample per
/// voxel of 0.1 m: the first that a beam meets. Map frame.
std::vector<Eigen::Vector3f> visible_surface_m(sim::DriveSimulator simulator);

/// points_m and visible_m: map frame of `truth`'s drive. Throws Error if either is empty.
/// Source of the measures: Knapitsch et al., "Tanks and Temples", 2017 (precision and recall of
/// surfaces within a distance).
MapError map_error(const std::vector<Eigen::Vector3f>& points_m,
                   const std::vector<Eigen::Vector3f>& visible_m, sim::DriveSimulator& truth);

}  // namespace hqslam::tools
