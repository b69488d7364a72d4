#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "alignment/drift.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/saved_map.h"
#include "loops/levelling.h"
#include "loops/pose_graph.h"
#include "map/mapping.h"
#include "map/recent_features.h"

namespace hqslam::slam {

/// The scan of a keyframe.
struct LoopView {
  OrganizedCloud cloud;
  MapFeatures features;
  ScanMotion motion;
  MapPoints left_window;  ///< points that left the window before the keyframe was inserted
};

/// A keyframe as it was inserted into the map.
struct LoopKeyframe {
  Pose T_map_sensor = Pose::Identity();
  Status mapping_status = Status::kOk;
  std::size_t scan = 0;  ///< its number in the trajectory
  /// The motion from the keyframe before is unknown: a segment of the trajectory begins.
  bool begins_segment = false;
  DriftState drift;
  std::optional<LoopView> view;  ///< of one every few metres, and of the first of a segment
  /// New measurements of gravity, here and at keyframes with a view before, for one with a view.
  std::vector<FeltGravity> gravity = {};
  bool is_inertial = false;  ///< whether the scan has inertial data
};

/// The drift after a loop: of the last node, and of segments whose covariance it reduced.
struct LoopedDrift {
  struct OfSegment {
    std::size_t segment = 0;
    Pose T_map_node = Pose::Identity();    ///< of one of its nodes, or near one
    Matrix6 unmeasured = Matrix6::Zero();  ///< DriftState::unmeasured at that pose
  };
  std::vector<OfSegment> segments;
  std::size_t last_segment = 0;
  Pose T_map_last = Pose::Identity();  ///< of the last node, before anything was corrected
  DriftImprovement last;               ///< at T_map_last
};

/// The trajectory of loop closing: keyframes, every few metres one that is a node of the pose
/// graph; segments, which begin where the motion is unknown; and submaps, each of the segments that
/// loops joined, with the points of the map that left the sliding window.
class KeyframeGraph {
 public:
  explicit KeyframeGraph(const MappingOptions& options) : options_(options), taken_(options) {}

  void add_keyframe(const LoopKeyframe& keyframe);
  /// The last keyframe, which has a view, becomes a node.
  void add_node(const LoopKeyframe& keyframe);
  void add_loops(const std::vector<PoseGraphEdge>& loops);
  /// Levels the odometry edges of the last segment by the gravity measured along it, or, where that
  /// contradicts the path, makes them what they were registered as, for good. Returns whether it
  /// did: only after the path has grown by a hundredth and 10 m since the last time.
  bool level();
  bool gravity_contradicts() const { return gravity_contradicts_; }
  /// A loop was accepted: the node with the larger covariance gets that of the other plus the
  /// loop's. They are not combined, since the estimates share most of their errors. To be called
  /// before move() and join().
  LoopedDrift improve_drift(const PoseGraphEdge& loop);

  /// Moves the keyframes and the submap of every segment with its nodes. In: poses of all nodes.
  /// Out: T_corrected_map of each keyframe.
  std::vector<Pose> move(const std::vector<Pose>& T_map_node);
  /// Merges two submaps that are in one frame now into the older one.
  void join(std::size_t submap, std::size_t other);
  /// Inserts points that left the window into the submap of the last keyframe.
  void insert(const MapPoints& points) { submaps_[own_submap()].insert(points); }
  /// Takes the points about the last node out.
  MapPoints take_near_last();

  bool empty() const { return nodes_.empty(); }
  std::size_t last() const { return nodes_.size() - 1; }
  const Pose& T_map_last() const { return graph_.T_map_node.back(); }
  std::size_t scan_of(std::size_t node) const { return nodes_[node].scan; }
  double path_m() const { return path_m_; }  ///< up to the last keyframe
  double path_m(std::size_t node) const { return nodes_[node].path_m; }
  const PoseGraph& poses() const { return graph_; }
  const std::vector<double>& edge_drift_m() const { return edge_drift_m_; }  ///< of odometry edges

  const std::vector<FeatureMaps>& submaps() const { return submaps_; }
  /// Copies of the points taken out about the last place that take_near_last() was called for.
  const FeatureMaps& taken() const { return taken_; }
  std::size_t own_submap() const { return segments_.back().submap; }
  std::size_t submap_of(std::size_t node) const;
  std::vector<std::size_t> submap_of_segment() const;
  std::vector<SavedPlace> places(std::size_t submap) const;

  /// The nodes of a submap with which the last one is compared: in the last segment those whose map
  /// has left the window.
  std::vector<std::size_t> older_nodes(std::size_t submap) const;
  const std::vector<ScanContext>& contexts() const { return contexts_; }  ///< one per node
  /// Of the last node: scan_contexts_from_lanes().
  const std::vector<ScanContext>& last_contexts() const { return last_contexts_; }
  MapFeatures features_about_last() const { return recent_.about_last(); }

 private:
  struct Node {
    std::uint32_t keyframe = 0;
    std::size_t scan = 0;
    double path_m = 0.0;
    DriftState drift;
  };
  struct Segment {
    std::uint32_t first_keyframe = 0;
    std::size_t first_node = 0;
    std::size_t submap = 0;
  };
  static constexpr std::size_t kRecentNodes = 5;

  std::size_t segment_of(std::size_t node) const;
  void set_unmeasured(std::size_t node, const Matrix6& covariance, LoopedDrift& result);
  std::vector<Pose> moved(std::size_t segment, const std::vector<Pose>& T_map_node) const;

  MappingOptions options_;
  std::vector<FeatureMaps> submaps_;
  FeatureMaps taken_;  ///< in the last segment
  std::vector<Segment> segments_;
  std::vector<Pose> T_map_keyframe_;
  double path_m_ = 0.0;
  double drift_m_ = 0.0;  ///< plausible drift since the last node
  std::vector<Node> nodes_;
  std::vector<ScanContext> contexts_;
  std::vector<ScanContext> last_contexts_;
  PoseGraph graph_;
  std::vector<Pose> T_node_next_;  ///< of odometry edges, before levelling
  std::vector<double> edge_drift_m_;
  std::vector<GravityAtNode> gravity_;  ///< of the last segment, nodes counted from its first
  bool gravity_contradicts_ = false;    ///< the path; none is used any more
  double next_levelled_m_ = 0.0;        ///< position along the path of the next levelling
  RecentFeatures recent_{kRecentNodes};
};

}  // namespace hqslam::slam
