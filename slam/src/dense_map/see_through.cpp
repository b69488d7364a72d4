#include "dense_map/see_through.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>

#include "dense_map/grid_walk.h"
#include "dense_map/voxel_votes.h"

namespace hqslam::slam {

namespace {

/// Nearer to the sensor is nothing but its mount.
constexpr double kBeginning_m = 0.3;
constexpr double kRayReach_voxels = 0.5;

struct PassedVoxel {
  std::uint32_t block = 0;
  std::uint16_t local = 0;
};

/// Whether a beam passes the mean of a voxel's points nearer than half a voxel.
bool is_near(const BeamSection& beam, const Eigen::Vector3d& mean_m, double reach_m) {
  return (mean_m - beam.origin_m).cross(beam.direction).squaredNorm() <= reach_m * reach_m;
}

/// The voxels that a section of a beam crosses, except those in which the scan has points.
void collect(const VoxelGrid& grid, const BeamSection& beam, std::uint32_t scan,
             std::vector<PassedVoxel>& passed) {
  const double voxel_m = grid.voxel_m();
  walk_grid(beam, voxel_m * VoxelBlock::kSide,
            [&](const Eigen::Vector3i& index, double begin_m, double end_m) {
              const VoxelBlock* const block = grid.find_block(index);
              if (block == nullptr) return;
              const auto number = static_cast<std::uint32_t>(block - grid.blocks().data());
              BeamSection inside = beam;
              inside.begin_m = begin_m;
              inside.end_m = end_m;
              walk_grid(inside, voxel_m, [&](const Eigen::Vector3i& voxel, double, double) {
                // Rounding at the border of the block: the neighbour is visited by itself.
                if (VoxelGrid::block_of(voxel) != index) return;
                const int local = VoxelGrid::local_of(voxel);
                if (!block->has(local)) return;
                const Voxel& found = block->at(local);
                if (found.last_scan == scan) return;
                const Eigen::Vector3d mean_m = voxel_m * (voxel.cast<double>() + mean_place(found));
                if (is_near(beam, mean_m, kRayReach_voxels * voxel_m)) {
                  passed.push_back({number, static_cast<std::uint16_t>(local)});
                }
              });
            });
}

/// A scan with points in a voxel does not vote against it.
void mark_ends(VoxelGrid& grid, const std::vector<Beam>& beams, std::uint32_t scan) {
  for (const Beam& beam : beams) {
    const auto voxel = grid.voxel_of(beam.end_m);
    Voxel* const found = voxel ? grid.find(*voxel) : nullptr;
    if (found != nullptr) found->last_scan = scan;
  }
}

void vote_against(VoxelGrid& grid, const std::vector<PassedVoxel>& passed, std::uint32_t scan) {
  for (const PassedVoxel& at : passed) {
    Voxel& voxel = grid.block(at.block).at(at.local);
    if (voxel.last_scan == scan) continue;
    voxel.last_scan = scan;
    count_up(voxel.times_seen_through);
  }
}

}  // namespace

void vote_against_seen_through(VoxelGrid& grid, const std::vector<Beam>& beams, std::uint32_t scan,
                               double max_range_m) {
  mark_ends(grid, beams, scan);
  std::vector<PassedVoxel> all_passed;
#pragma omp parallel
  {
    std::vector<PassedVoxel> passed;
#pragma omp for schedule(dynamic, 64) nowait
    for (std::size_t i = 0; i < beams.size(); ++i) {
      const Eigen::Vector3d to_end_m = beams[i].end_m - beams[i].origin_m;
      const double range_m = to_end_m.norm();
      const double end_m = std::min(seen_through_m(range_m, grid.voxel_m()), max_range_m);
      if (end_m <= kBeginning_m) continue;
      collect(grid, {beams[i].origin_m, to_end_m / range_m, kBeginning_m, end_m}, scan, passed);
    }
    // One vote per voxel, from whichever beam and thread.
#pragma omp critical
    all_passed.insert(all_passed.end(), passed.begin(), passed.end());
  }
  vote_against(grid, all_passed, scan);
}

}  // namespace hqslam::slam
