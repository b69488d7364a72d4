#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "dense_map/voxel_grid.h"

namespace hqslam::slam {

/// How much a point says for the voxel that it is in. Fixed-point numbers: see Voxel.
struct PointVote {
  std::uint16_t odds = 0;   ///< 0: the point is left out
  std::uint8_t weight = 0;  ///< in the mean, 1 to 16
  bool measured = false;
};
PointVote measured_vote();
/// confidence: of a computed point, 0 to 1.
PointVote computed_vote(float confidence);

/// A point of scan `scan` at a place within its voxel, 0 to 1 along each axis.
void vote_for(Voxel& voxel, const Eigen::Vector3d& place, const PointVote& vote,
              std::uint32_t scan);

/// Takes the intensity of a point in, before vote_for takes in the point; not finite: not known.
void add_intensity(VoxelIntensity& sum, float intensity, const Voxel& voxel, const PointVote& vote);
/// Not a number where none is known.
float mean_intensity(const VoxelIntensity& sum);

/// Mean place of the points within the voxel, 0 to 1 along each axis.
Eigen::Vector3d mean_place(const Voxel& voxel);

/// What a voxel says for those that it touches: 0 to 1.
double support_of(const Voxel& voxel);

/// The probability that there is a surface; support: of the 26 neighbours together. See DenseMap.
double confidence_of(const Voxel& voxel, double support);

}  // namespace hqslam::slam
