#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>

#include "dense_map/voxel_grid.h"

namespace hqslam::slam {

/// The vote of a point for its voxel, in the fixed-point numbers of Voxel.
struct PointVote {
  std::uint16_t odds = 0;   ///< 0: the point is left out
  std::uint8_t weight = 0;  ///< in the mean, 1 to 16
  bool measured = false;
};
PointVote measured_vote();
/// confidence: of a point of a computed row, 0 to 1.
PointVote computed_vote(float confidence);

/// A point of scan `scan`. place: its position within the voxel, 0 to 1 along each axis. An
/// intensity that is not finite is unknown.
void vote_for(Voxel& voxel, const Eigen::Vector3d& place, const PointVote& vote, std::uint32_t scan,
              float intensity = std::numeric_limits<float>::quiet_NaN());

/// NaN where none is known.
float mean_intensity(const Voxel& voxel);

/// Mean position of the points within the voxel, 0 to 1 along each axis.
Eigen::Vector3d mean_place(const Voxel& voxel);

/// The vote of a voxel for its neighbours: 0 to 1.
double support_of(const Voxel& voxel);

/// The probability of a surface in the voxel (DenseMap). support: sum over the 26 neighbours.
double confidence_of(const Voxel& voxel, double support);

}  // namespace hqslam::slam
