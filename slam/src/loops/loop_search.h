#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hqslam/slam/scan_context.h"
#include "hqslam/slam/status.h"
#include "loops/loop_search.h"
#include "loops/loop_verification.h"
#include "loops/pose_graph.h"
#include "map/mapping.h"

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

/// What a search for loops of the last node is made in.
struct LoopSearchSpace {
  const MappingOptions& options;
  const FeatureMaps& map;  ///< in which the nodes are that are asked
  const PoseGraph& graph;
  const std::vector<ScanContext>& contexts;       ///< one per node
  const std::vector<ScanContext>& last_contexts;  ///< of the last node, scan_contexts_from_lanes()
  const std::vector<PlausibleDrift>& drift;       ///< one per node
  const MapFeatures& features;                    ///< about the last node, in its frame
  const std::vector<std::size_t>& nodes;          ///< that are asked
};

/// The last node, recognised at an older place.
struct FoundLoop {
  std::size_t node = 0;                ///< the older one
  Pose T_map_last = Pose::Identity();  ///< where the older map puts the last node
  double overlap = 0.0;
};

struct LoopSearchResult {
  LoopStatus status = LoopStatus::kNoCandidate;
  int candidates = 0;
  std::optional<FoundLoop> loop;
};

/// The local map about a place with which a node is compared.
Surroundings loop_surroundings(const Pose& T_map_place);

/// Looks where the last node is believed to be: nothing if no older node is near, or the features
/// do not fit the older map there.
std::optional<FoundLoop> loop_at(const LoopSearchSpace& space, const Pose& T_map_last_believed);

/// Looks where the last node is believed to be, and if it does not fit there, at all places within
/// reach of plausible drift that look like it. A place counts if the registration is accepted
/// (verify_loop) and moves the node no farther than plausible. Of several places that fit, none
/// is taken unless one fits much better than all others.
LoopSearchResult search_loop(const LoopSearchSpace& space);

/// The same without looking where the last node is believed to be.
LoopSearchResult search_similar_places(const LoopSearchSpace& space);

}  // namespace hqslam::slam
