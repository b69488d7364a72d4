#pragma once

#include <cstddef>
#include <vector>

#include "hqslam/slam/scan_context.h"
#include "loops/pose_graph.h"

namespace hqslam::slam {

/// How far off an estimate can be.
struct PlausibleDrift {
  double translation_m = 0.0;
  double rotation_rad = 0.0;
};

/// How far off each node can be from where it is believed to be, seen from the last node.
///
/// Drift comes up along the path, `edge_drift_m[i]` on the odometry's edge i, and ends
/// where a place is recognised: the least sum over all ways through the graph (Dijkstra), plus what
/// two passes of a place differ in anyway. Where no way leads, anything is plausible.
std::vector<PlausibleDrift> plausible_drift(const PoseGraph& graph,
                                            const std::vector<double>& edge_drift_m);

/// A place that the last node may have come back to.
struct LoopCandidate {
  std::size_t node = 0;
  ScanContextMatch match;
};

/// The older nodes within reach of plausible drift that look most like the last one.
///
/// In: graph, one scan context per node, those of the last one (from where it stands and from the
/// lanes beside), the drift, the nodes that are asked. Out: at most `max_candidates`, best first,
/// no two within 12 m of each other.
std::vector<LoopCandidate> loop_candidates(const PoseGraph& graph,
                                           const std::vector<ScanContext>& contexts,
                                           const std::vector<ScanContext>& last_contexts,
                                           const std::vector<PlausibleDrift>& drift,
                                           const std::vector<std::size_t>& nodes,
                                           std::size_t max_candidates);

}  // namespace hqslam::slam
