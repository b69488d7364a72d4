#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hqslam/core/pose.h"
#include "loops/pose_graph.h"

namespace hqslam::slam {

/// A measured motion from one node to another.
struct PoseGraphEdge {
  std::size_t from = 0;
  std::size_t to = 0;
  Pose T_from_to = Pose::Identity();
  double translation_sigma_m = 1.0;
  double rotation_sigma_rad = 1.0;
};

/// Poses along a path, and what was measured between them.
struct PoseGraph {
  std::vector<Pose> T_map_node;
  std::vector<PoseGraphEdge> odometry;  ///< from a node to the next; none where the way was lost
  std::vector<PoseGraphEdge> loops;     ///< between places that were recognised
  std::size_t held = 0;                 ///< so many of the first nodes stay where they are
};

/// By how much two poses disagree with an edge: E = T_from_to^-1 (T_map_from^-1 T_map_to).
Pose disagreement(const PoseGraphEdge& edge, const std::vector<Pose>& T_map_node);

/// The poses that agree best with all edges; empty if no solution was found.
///
///   minimise  sum over odometry |r|^2 + sum over loops rho(|r|^2),
///   r = (translation of E / translation sigma, 2 vec(q of E) / rotation sigma),
/// with rho the Cauchy loss; the first node of every component that edges join is held, and so are
/// the graph's `held` ones. A far correction lies beyond the reach of a robust loss, so the problem
/// is solved without it first. If some loop is then off by more than the loss forgives, it is
/// solved with it from there: a loop that the others contradict is let go (the first and last step
/// of graduated non-convexity, Yang et al., RA-L 2020). If none is, that step is left out: where a
/// path drifts always to the same side its edges are strained by far more than their sigmas, and
/// the loss would rather let all loops go. Ceres, Levenberg-Marquardt, sparse Cholesky, one thread.
std::vector<Pose> optimized(const PoseGraph& graph);

/// Whether poses bend no edge of the graph more than it can bear: an odometry edge by more than
/// twice its plausible drift, a loop by more than registrations of one place differ.
bool is_plausible(const PoseGraph& graph, const std::vector<double>& edge_drift_m,
                  const std::vector<Pose>& T_map_node);

/// Poses of all keyframes after the nodes among them moved.
///
/// In: poses of keyframes, which of them are nodes (rising, the first keyframe is one), the
/// nodes' new poses. Out: new poses. A keyframe between two nodes is carried along by either, and
/// lies between the two by its place in the path; those after the last node go with it. What would
/// move by less than a millimetre stays where it is, so that most of the map need not be touched.
std::vector<Pose> corrected_keyframes(const std::vector<Pose>& T_map_keyframe,
                                      const std::vector<std::uint32_t>& keyframe_of_node,
                                      const std::vector<Pose>& T_map_node);

}  // namespace hqslam::slam
