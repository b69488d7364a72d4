#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hqslam/slam/loop_report.h"
#include "hqslam/slam/scan_context.h"
#include "loops/loop_candidates.h"
#include "loops/loop_verification.h"
#include "loops/pose_graph.h"
#include "map/mapping.h"

namespace hqslam::slam {

/// The input of a search for loops of the last node.
struct LoopSearchSpace {
  const MappingOptions& options;
  const FeatureMaps& map;  ///< the submap of `nodes`
  const PoseGraph& graph;
  const std::vector<ScanContext>& contexts;       ///< one per node
  const std::vector<ScanContext>& last_contexts;  ///< of the last node, scan_contexts_from_lanes()
  const std::vector<PlausibleDrift>& drift;       ///< one per node
  const MapFeatures& features;                    ///< about the last node, in its frame
  const std::vector<std::size_t>& nodes;          ///< to compare with
  /// Points of the submap that are in the sliding window again, since a loop was found near them.
  const FeatureMaps* taken = nullptr;
};

/// The last node, recognized at an older place.
struct FoundLoop {
  std::size_t node = 0;                ///< the older one
  Pose T_map_last = Pose::Identity();  ///< of the last node, in the older map
  double overlap = 0.0;
};

struct LoopSearchResult {
  LoopStatus status = LoopStatus::kNoCandidate;
  int candidates = 0;
  std::optional<FoundLoop> loop;
};

/// The local map about a place with which a node is compared.
Surroundings loop_surroundings(const Pose& T_map_place);

/// Tries an estimated pose of the last node: nothing if no older node is near, or the features do
/// not fit the older map there.
std::optional<FoundLoop> loop_at(const LoopSearchSpace& space, const Pose& T_map_last_estimated);

/// Tries the estimated pose of the last node and, if it does not fit there, all similar places
/// within reach of plausible drift. A place counts if the registration is accepted (verify_loop)
/// and moves the node no farther than plausible. Of several places that fit, none is taken unless
/// one fits much better than all others.
LoopSearchResult search_loop(const LoopSearchSpace& space);

/// search_loop() without the estimated pose.
LoopSearchResult search_similar_places(const LoopSearchSpace& space);

}  // namespace hqslam::slam
