#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hqslam/slam/loop_report.h"
#include "loops/keyframe_graph.h"
#include "loops/loop_search.h"

namespace hqslam::slam {

struct LoopResult {
  LoopReport report;
  /// T_corrected_map of each keyframe; empty if nothing moved.
  std::vector<Pose> corrections;
  MapPoints restored;                          ///< points that return to the sliding window
  std::vector<std::size_t> submap_of_segment;  ///< KeyframeGraph::submap_of_segment()
  std::optional<LoopedDrift> drift;            ///< if loops were accepted
  bool gravity_contradicts = false;            ///< KeyframeGraph::gravity_contradicts()
};

/// Recognizes places passed before and corrects the path.
///
/// Every few metres a keyframe becomes a node of the pose graph. From time to time the last node is
/// compared with older places (search_loop), in the map that left the sliding window. A loop counts
/// only when further nodes, over a length of path, are found where it predicts them, or if it
/// confirms the node's present pose. Then the poses are corrected if that bends the path no more
/// than plausible, and the loops become edges of the pose graph. Otherwise nothing changes.
///
/// After tracking was lost a segment begins, with a submap and a frame of its own. Its nodes are
/// compared with all places of the other submaps; loops that agree join the submaps.
class LoopClosing {
 public:
  /// searches: if false, only the points that leave the window are kept.
  LoopClosing(const MappingOptions& options, bool searches)
      : options_(options), searches_(searches), graph_(options) {}

  /// In: the keyframes since the last call.
  LoopResult process(std::vector<LoopKeyframe> keyframes);

  const KeyframeGraph& graph() const { return graph_; }

 private:
  LoopResult search();
  LoopReport look_around();
  LoopReport look_where_predicted();
  template <typename Look>
  auto look_in(std::size_t submap, const Look& look) const;
  Pose T_corrected_map(const PoseGraphEdge& loop) const;
  void await_others(const FoundLoop& loop);
  bool enough_agree() const;
  void forget_waiting();
  void close(LoopResult& result);
  void move(const std::vector<Pose>& T_map_node, LoopResult& result);
  void stand_upright(LoopResult& result);
  void bring_together(PoseGraph& graph, const PoseGraphEdge& loop) const;

  MappingOptions options_;
  bool searches_;
  KeyframeGraph graph_;
  double next_search_m_ = 0.0;  ///< along the path
  // Loops that wait for others to agree with them.
  std::vector<PoseGraphEdge> waiting_;
  int missed_ = 0;  ///< nodes since, not found where predicted
};

}  // namespace hqslam::slam
