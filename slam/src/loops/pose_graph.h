#pragma once

#include <cstddef>
#include <vector>

#include "hqslam/core/pose.h"

namespace hqslam::slam {

/// A measured motion from one node to another.
struct PoseGraphEdge {
  std::size_t from = 0;
  std::size_t to = 0;
  Pose T_from_to = Pose::Identity();
  double translation_sigma_m = 1.0;
  double rotation_sigma_rad = 1.0;
};

/// Poses along a path and the measured motions between them.
struct PoseGraph {
  std::vector<Pose> T_map_node;
  std::vector<PoseGraphEdge> odometry;  ///< from a node to the next; none after tracking was lost
  std::vector<PoseGraphEdge> loops;     ///< between recognized places
};

/// The residual of an edge: E = T_from_to^-1 (T_map_from^-1 T_map_to).
Pose disagreement(const PoseGraphEdge& edge, const std::vector<Pose>& T_map_node);

/// Whether a motion is no longer and turns no farther than the limits.
bool is_within(const Pose& motion, double max_m, double max_rad);

/// The poses that agree best with all edges; empty if no solution was found.
///
///   minimise  sum over odometry |r|^2 + sum over loops rho(|r|^2),
///   r = (translation of E / translation sigma, 2 vec(q of E) / rotation sigma),
/// with rho the Cauchy loss; the first node of every component that edges join is held. A far
/// correction is beyond the reach of a robust loss, so the problem is solved without it first. If a
/// loop's residual then exceeds what the loss tolerates, the problem is solved again with it from
/// there: a loop that the others contradict is rejected (the first and last step of graduated
/// non-convexity, Yang et al., RA-L 2020). Otherwise that step is left out: where a
/// path drifts always to the same side its edges are strained by far more than their sigmas, and
/// the loss would reject all loops. Ceres, Levenberg-Marquardt, sparse Cholesky, one thread.
std::vector<Pose> optimized(const PoseGraph& graph);

}  // namespace hqslam::slam
