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
  /// Nothing measured the way from the keyframe before: a segment of the trajectory begins.
  bool begins_segment = false;
  DriftState drift;
  std::optional<LoopView> view;  ///< of one every few metres, and of the first of a segment
  /// Where it was felt anew, of one with a view.
  std::optional<FeltGravity> gravity = std::nullopt;
  bool is_inertial = false;  ///< an inertial sensor feels it here and there
};

/// What a loop found out about drift: of the last node, and of segments whose poses were less known
/// than that.
struct LoopedDrift {
  struct OfSegment {
    std::size_t segment = 0;
    Pose T_map_node = Pose::Identity();    ///< of one of its nodes, or near it
    Matrix6 unmeasured = Matrix6::Zero();  ///< there
  };
  std::vector<OfSegment> segments;
  std::size_t last_segment = 0;
  Pose T_map_last = Pose::Identity();  ///< of the last node, before anything was corrected
  DriftImprovement last;               ///< there
};

/// The trajectory as loop closing sees it: keyframes, every few metres one that is a node of the
/// pose graph; segments, which begin where nothing measured the way; and submaps, each of the
/// segments that loops have joined, with the points of the map that left the sliding window.
class KeyframeGraph {
 public:
  explicit KeyframeGraph(const MappingOptions& options) : options_(options) {}

  void add_keyframe(const LoopKeyframe& keyframe);
  /// The last keyframe, which has a view, becomes a node.
  void add_node(const LoopKeyframe& keyframe);
  void add_loops(const std::vector<PoseGraphEdge>& loops);
  /// Turns the odometry edges of the last segment upright, by what gravity said along it. Whether
  /// it did: only when the path is a hundredth and 10 m longer than the last time.
  bool level();
  /// A loop was accepted: of its two nodes the one that is known less well is known by the other
  /// now. Nothing is combined: the estimates share most of their errors. Call it before move() and
  /// join().
  LoopedDrift improve_drift(const PoseGraphEdge& loop);

  /// Every segment moves with its nodes, and so do its keyframes and submap. In: poses of all
  /// nodes. Out: per keyframe T_corrected_map.
  std::vector<Pose> move(const std::vector<Pose>& T_map_node);
  /// Of two submaps that are in one frame now the younger becomes one with the older.
  void join(std::size_t submap, std::size_t other);
  /// Puts points that left the window into the submap of the last keyframe.
  void insert(const MapPoints& points) { submaps_[own_submap()].insert(points); }
  /// Takes the points about the last node out again.
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
  std::size_t own_submap() const { return segments_.back().submap; }
  std::size_t submap_of(std::size_t node) const;
  std::vector<std::size_t> submap_of_segment() const;
  std::vector<SavedPlace> places(std::size_t submap) const;

  /// The nodes of a submap that a place is looked for at: of the last segment those about which the
  /// map left the window.
  std::vector<std::size_t> older_nodes(std::size_t submap) const;
  const std::vector<ScanContext>& contexts() const { return contexts_; }  ///< one per node
  /// Of the last node, from its lane and those beside.
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
  std::vector<Segment> segments_;
  std::vector<Pose> T_map_keyframe_;
  double path_m_ = 0.0;
  double drift_m_ = 0.0;  ///< plausible since the last node
  std::vector<Node> nodes_;
  std::vector<ScanContext> contexts_;
  std::vector<ScanContext> last_contexts_;
  PoseGraph graph_;
  std::vector<Pose> T_node_next_;  ///< of odometry edges, as registered
  std::vector<double> edge_drift_m_;
  std::vector<GravityAtNode> gravity_;  ///< of the last segment, nodes counted from its first
  double next_levelled_m_ = 0.0;        ///< along the path
  RecentFeatures recent_{kRecentNodes};
};

}  // namespace hqslam::slam
