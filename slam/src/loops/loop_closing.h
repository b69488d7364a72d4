#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/loop_report.h"
#include "hqslam/slam/mapping.h"
#include "hqslam/slam/saved_map.h"
#include "loops/loop_search.h"
#include "loops/pose_graph.h"
#include "map/recent_features.h"

namespace hqslam::slam {

/// A key frame as it was put into the map.
struct LoopKeyFrame {
  const OrganizedCloud& cloud;
  const MapFeatures& features;
  Twist velocity;  ///< a second
  Pose T_map_sensor = Pose::Identity();
  Status mapping_status = Status::kOk;
  std::size_t scan = 0;  ///< its number in the trajectory
};

struct LoopResult {
  LoopReport report;
  /// Per key frame T_corrected_map, which takes its points to where they belong; empty if nothing
  /// moved.
  std::vector<Pose> corrections;
};

/// Recognises places passed before and finds where the path really went.
///
/// Every few metres a key frame becomes a node of the pose graph. From time to time the last
/// node is looked for at older places (search_loop). A loop counts only when further nodes, over a
/// stretch of path, are found where it predicts them; then all of them are put into the pose graph,
/// and the poses are corrected if that bends the path no more than plausible. Otherwise the loops
/// are taken out again.
class LoopClosing {
 public:
  /// Call for every key frame, in order, after it was put into the map.
  LoopResult process(const LoopKeyFrame& key_frame, const Mapping& mapping);

  /// Where the nodes are now, to be recognised by later drives.
  std::vector<SavedPlace> places() const;

 private:
  struct Node {
    std::uint32_t key_frame = 0;
    std::size_t scan = 0;
    double path_m = 0.0;
  };
  static constexpr std::size_t kRecentNodes = 5;

  void add_key_frame(const LoopKeyFrame& key_frame);
  void add_node(const LoopKeyFrame& key_frame);
  LoopResult search(const Mapping& mapping);
  LoopReport look_around(const LoopSearchSpace& space);
  LoopReport look_where_predicted(const LoopSearchSpace& space);
  PoseGraphEdge edge_of(const FoundLoop& loop) const;
  void await_others(const FoundLoop& loop);
  bool enough_agree() const;
  void forget_waiting();
  std::vector<Pose> align(LoopReport& report);
  std::vector<Pose> close(LoopReport& report);
  std::vector<Pose> move_key_frames(const std::vector<Pose>& T_map_node);

  std::vector<Pose> T_map_key_frame_;
  double path_m_ = 0.0;   ///< up to the last key frame
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
