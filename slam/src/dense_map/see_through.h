#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "dense_map/voxel_grid.h"

namespace hqslam::slam {

/// A measured beam in the map frame: from the sensor to the surface that returned it.
struct Beam {
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d end_m = Eigen::Vector3d::Zero();
};

/// The distance up to which a beam votes against what it crosses: a beam that meets a plane at a
/// grazing angle stays within the thickness of a voxel for voxel_m range_m / 1.5 m if the plane
/// passes the sensor at 1.5 m (the ground, a parked car, a wall); 0.3 m more are left out.
inline double seen_through_m(double range_m, double voxel_m) {
  return range_m - (0.3 + voxel_m * range_m / 1.5);
}

/// One vote against every voxel that a beam of the scan crossed and in which none of its beams
/// ended.
///
/// A beam crosses a voxel if it passes the mean of its points within half a voxel, up to
/// seen_through_m() and max_range_m.
/// scan: number of the call, counted together with the insertions of scans.
void vote_against_seen_through(VoxelGrid& grid, const std::vector<Beam>& beams, std::uint32_t scan,
                               double max_range_m);

}  // namespace hqslam::slam
