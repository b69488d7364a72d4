#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "dense_map/voxel_grid.h"

namespace hqslam::slam {

/// A measured beam, map frame: from where the sensor was to what it met.
struct Beam {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d end_m = Eigen::Vector3d::Zero();
};

/// One vote against every voxel that a beam of the scan went through and none of its beams ended
/// in.
///
/// A beam goes through a voxel if it passes the mean of its points within half a voxel, and if the
/// voxel lies before the beam's end by more than
///   m(r) = 0.3 m + voxel_m r / 1.5 m,  r the beam's range.
/// A beam that meets a plane at a grazing angle runs within it for a while: one whose plane passes
/// the sensor at 1.5 m (the ground, a parked car, a wall) leaves the thickness of a voxel after
/// voxel_m r / 1.5 m. No beam looks farther than max_range_m.
/// `scan` counts all calls that say something about voxels, insert's too.
void vote_against_seen_through(VoxelGrid& grid, const std::vector<Beam>& beams, std::uint32_t scan,
                               double max_range_m);

}  // namespace hqslam::slam
