#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/loop_report.h"
#include "hqslam/slam/saved_map.h"
#include "loops/loop_search.h"
#include "loops/pose_graph.h"
#include "map/mapping.h"
#include "map/recent_features.h"

namespace hqslam::slam {

/// What a keyframe saw.
struct LoopView {
  OrganizedCloud cloud;
  MapFeatures features;
  Twist velocity;         ///< per second
  MapPoints left_window;  ///< taken out of the map before it was put there
};

/// A keyframe as it was put into the map.
struct LoopKeyframe {
  Pose T_map_sensor = Pose::Identity();
  Status mapping_status = Status::kOk;
  std::size_t scan = 0;  ///< its number in the trajectory
  /// Nothing measured the way from the keyframe before: a stretch of path begins.
  bool begins_segment = false;
  std::optional<LoopView> view;  ///< of one every few metres, and of the first of a stretch
};

struct LoopResult {
  LoopReport report;
  /// Per keyframe T_corrected_map, which takes its points to where they belong; empty if nothing
  /// moved.
  std::vector<Pose> corrections;
  MapPoints recalled;                          ///< to be matched with again, where they belong
  std::vector<std::size_t> submap_of_segment;  ///< LoopClosing::submap_of_segment()
};

/// Recognises places passed before and finds where the path really went.
///
/// Every few metres a keyframe becomes a node of the pose graph. From time to time the last
/// node is looked for at older places (search_loop), in what was laid aside of the map. A loop
/// counts only when further nodes, over a stretch of path, are found where it predicts them; then
/// all of them are put into the pose graph, and the poses are corrected if that bends the path no
/// more than plausible. Otherwise the loops are taken out again.
///
/// Where the way was lost the path begins anew, with a map and a frame of its own. Its nodes are
/// looked for in all other parts, wherever they may be; loops that agree join the parts.
class LoopClosing {
 public:
  /// If it does not search it keeps what is laid aside, no more.
  LoopClosing(const MappingOptions& mapping, bool searches);

  /// In: the keyframes since the last call.
  LoopResult process(std::vector<LoopKeyframe> keyframes);

  /// What was laid aside, by part.
  const std::vector<FeatureMaps>& parts() const { return submaps_; }
  /// The stretches of path by their part: those that were joined have the number of the first.
  std::vector<std::size_t> submap_of_segment() const;
  /// Where the nodes of a part are now, to be recognised by later drives.
  std::vector<SavedPlace> places(std::size_t part) const;

 private:
  struct Node {
    std::uint32_t keyframe = 0;
    std::size_t scan = 0;
    double path_m = 0.0;
  };
  struct Segment {
    std::uint32_t first_keyframe = 0;
    std::size_t first_node = 0;
    std::size_t part = 0;
  };
  static constexpr std::size_t kRecentNodes = 5;

  void add_keyframe(const LoopKeyframe& keyframe);
  void add_node(const LoopKeyframe& keyframe);
  LoopResult search();
  LoopReport look_around();
  LoopReport look_where_predicted();
  std::vector<std::size_t> nodes_to_ask(std::size_t part) const;
  template <typename Look>
  auto look_in(std::size_t part, const Look& look) const;
  std::size_t submap_of(std::size_t node) const;
  PoseGraphEdge edge_of(const FoundLoop& loop) const;
  void await_others(const FoundLoop& loop);
  bool enough_agree() const;
  void forget_waiting();
  std::vector<Pose> align(LoopReport& report);
  std::vector<Pose> close(LoopReport& report);
  void bring_together(PoseGraph& graph) const;
  void join(std::size_t part, std::size_t other);
  std::vector<Pose> corrected(std::size_t stretch, const std::vector<Pose>& T_map_node) const;
  std::vector<Pose> move_keyframes(const std::vector<Pose>& T_map_node);

  MappingOptions mapping_;
  bool searches_;
  std::vector<FeatureMaps> submaps_;
  std::vector<Segment> segments_;
  std::vector<Pose> T_map_keyframe_;
  double path_m_ = 0.0;   ///< up to the last keyframe
  double drift_m_ = 0.0;  ///< plausible since the last node
  std::vector<Node> nodes_;
  std::vector<ScanContext> contexts_;       ///< one per node
  std::vector<ScanContext> last_contexts_;  ///< of the last node, from its lane and those beside
  PoseGraph graph_;
  std::vector<double> edge_drift_m_;  ///< one per odometry edge
  RecentFeatures recent_{kRecentNodes};
  double next_search_m_ = 0.0;  ///< along the path
  // Loops that wait for others to agree with them.
  std::vector<PoseGraphEdge> waiting_;
  Pose T_corrected_map_ = Pose::Identity();  ///< what they say about the last node
  int missed_ = 0;                           ///< nodes since, not found where predicted
};

}  // namespace hqslam::slam
