#pragma once

#include <cstddef>
#include <vector>

#include "hqslam/slam/scan_context.h"
#include "loops/pose_graph.h"

namespace hqslam::slam {

/// Largest plausible error of an estimate.
struct PlausibleDrift {
  double translation_m = 0.0;
  double rotation_rad = 0.0;
};

/// The plausible error of each node's pose relative to the last node.
///
/// Drift accumulates along the path, `edge_drift_m[i]` on the odometry's edge i, and ends where a
/// place is recognized: the shortest path through the graph (Dijkstra), plus the distance between
/// two passes of a place. Unlimited for nodes that are not connected.
std::vector<PlausibleDrift> plausible_drift(const PoseGraph& graph,
                                            const std::vector<double>& edge_drift_m);

/// A place that the last node may have come back to.
struct LoopCandidate {
  std::size_t node = 0;
  ScanContextMatch match;
};

/// The older nodes within reach of plausible drift whose scan contexts are most similar to the last
/// one's.
///
/// In: graph, one scan context per node, those of the last one (scan_contexts_from_lanes), the
/// drift, the nodes to compare with. Out: at most `max_candidates`, best first, no two within 12 m
/// of each other.
std::vector<LoopCandidate> loop_candidates(const PoseGraph& graph,
                                           const std::vector<ScanContext>& contexts,
                                           const std::vector<ScanContext>& last_contexts,
                                           const std::vector<PlausibleDrift>& drift,
                                           const std::vector<std::size_t>& nodes,
                                           std::size_t max_candidates);

}  // namespace hqslam::slam
