#include "loops/keyframe_graph.h"

#include <algorithm>
#include <utility>

#include "alignment/rigid_alignment.h"
#include "loops/loop_correction.h"
#include "loops/loop_search.h"

namespace hqslam::slam {

namespace {

// Largest drift of scan-to-map matching as a share of the path.
constexpr double kDriftShare = 0.03;  // chosen in simulation alone
constexpr double kDriftShareUnobserved = 0.3;

// Sigmas of odometry edges. With a quarter of kSigmaPerDrift drives of 1 % drift are not closed
// (simulated drives alone).
constexpr double kLeastSigma_m = 0.01;
constexpr double kLeastSigma_rad = 0.001;
constexpr double kSigmaPerDrift = 1.0 / 3.0;
constexpr double kSigma_rad_per_m = 0.005;

// Spacing of levellings, which take time and move the map.
constexpr double kLevelledEvery_m = 10.0;
constexpr double kLevelledEveryShare = 0.01;

/// A measure to compare two covariances by; angles have a lever of 10 m.
double size_of(const Matrix6& covariance) {
  const auto variance = covariance.diagonal();
  return variance.head<3>().sum() + kLever_m * kLever_m * variance.tail<3>().sum();
}

}  // namespace

void KeyframeGraph::add_keyframe(const LoopKeyframe& keyframe) {
  if (T_map_keyframe_.empty() || keyframe.begins_segment) {
    segments_.push_back(
        {static_cast<std::uint32_t>(T_map_keyframe_.size()), nodes_.size(), submaps_.size()});
    submaps_.emplace_back(options_);
    taken_ = FeatureMaps(options_);
    recent_ = RecentFeatures(kRecentNodes);
    gravity_.clear();
    drift_m_ = 0.0;
  } else {
    const double step_m = distance_m(keyframe.T_map_sensor, T_map_keyframe_.back());
    const bool observed =
        keyframe.mapping_status == Status::kOk || keyframe.mapping_status == Status::kNotConverged;
    path_m_ += step_m;
    drift_m_ += (observed ? kDriftShare : kDriftShareUnobserved) * step_m;
  }
  T_map_keyframe_.push_back(keyframe.T_map_sensor);
}

void KeyframeGraph::add_node(const LoopKeyframe& keyframe) {
  if (nodes_.size() > segments_.back().first_node) {
    const double sigma_m = kSigmaPerDrift * drift_m_;
    graph_.odometry.push_back({nodes_.size() - 1, nodes_.size(),
                               graph_.T_map_node.back().inverse() * keyframe.T_map_sensor,
                               kLeastSigma_m + sigma_m,
                               kLeastSigma_rad + kSigma_rad_per_m * sigma_m});
    T_node_next_.push_back(graph_.odometry.back().T_from_to);
    edge_drift_m_.push_back(drift_m_);
  }
  drift_m_ = 0.0;
  graph_.T_map_node.push_back(keyframe.T_map_sensor);
  nodes_.push_back({static_cast<std::uint32_t>(T_map_keyframe_.size() - 1), keyframe.scan, path_m_,
                    keyframe.drift});
  const auto first = nodes_.begin() + static_cast<std::ptrdiff_t>(segments_.back().first_node);
  for (const FeltGravity& felt : keyframe.gravity) {
    const auto node = std::ranges::lower_bound(first, nodes_.end(), felt.scan, {}, &Node::scan);
    if (node != nodes_.end() && node->scan == felt.scan) {
      gravity_.push_back({static_cast<std::size_t>(node - first), felt});
    }
  }
  last_contexts_ = scan_contexts_from_lanes(keyframe.view->cloud);
  contexts_.push_back(last_contexts_.front());
  recent_.add(keyframe.view->features, keyframe.T_map_sensor, keyframe.view->motion);
}

void KeyframeGraph::add_loops(const std::vector<PoseGraphEdge>& loops) {
  graph_.loops.insert(graph_.loops.end(), loops.begin(), loops.end());
}

bool KeyframeGraph::level() {
  if (gravity_contradicts_ || gravity_.empty() || path_m_ < next_levelled_m_) return false;
  next_levelled_m_ = kLevelledEvery_m + (1.0 + kLevelledEveryShare) * path_m_;
  std::vector<Pose> T_first_node{Pose::Identity()};
  const std::size_t first_edge =
      graph_.odometry.size() - (nodes_.size() - 1 - segments_.back().first_node);
  for (std::size_t i = first_edge; i < graph_.odometry.size(); ++i) {
    T_first_node.push_back(orthonormalized(T_first_node.back() * T_node_next_[i]));
  }
  const std::optional<std::vector<Pose>> upright = levelled(T_first_node, gravity_);
  for (std::size_t i = first_edge; i < graph_.odometry.size(); ++i) {
    const std::size_t from = i - first_edge;
    graph_.odometry[i].T_from_to =
        upright ? (*upright)[from].inverse() * (*upright)[from + 1] : T_node_next_[i];
  }
  gravity_contradicts_ = !upright;
  return true;
}

std::size_t KeyframeGraph::segment_of(std::size_t node) const {
  const auto after = std::ranges::upper_bound(segments_, node, {}, &Segment::first_node);
  return static_cast<std::size_t>(after - segments_.begin()) - 1;
}

std::size_t KeyframeGraph::submap_of(std::size_t node) const {
  return segments_[segment_of(node)].submap;
}

LoopedDrift KeyframeGraph::improve_drift(const PoseGraphEdge& loop) {
  const DriftState from = nodes_[loop.from].drift;
  const DriftState to = nodes_[loop.to].drift;
  const Vector6 sigma = six(loop.translation_sigma_m, loop.rotation_sigma_rad);
  const Matrix6 of_loop = sigma.cwiseAbs2().asDiagonal();
  LoopedDrift result;
  result.last_segment = segment_of(last());
  result.T_map_last = T_map_last();
  result.last.before = nodes_.back().drift;
  const DriftState at_to = carried(from, loop.T_from_to);
  const DriftState at_from = carried(to, loop.T_from_to.inverse());
  const auto is_less_known = [&](const DriftState& state, const DriftState& by_loop) {
    return !by_loop.is_anywhere &&
           (state.is_anywhere || size_of(by_loop.total() + of_loop) < size_of(state.total()));
  };
  if (segment_of(loop.from) == segment_of(loop.to)) {
    if (size_of(at_to.drift + of_loop) < size_of(to.drift)) {
      nodes_[loop.to].drift.drift = at_to.drift + of_loop;
    }
  } else if (is_less_known(to, at_to)) {
    set_unmeasured(loop.to, at_to.total() + of_loop, result);
  } else if (is_less_known(from, at_from)) {
    set_unmeasured(loop.from, at_from.total() + of_loop, result);
  }
  result.last.after = nodes_.back().drift;
  return result;
}

/// Sets the covariance of a node, and with it that of all segments in one frame with it.
void KeyframeGraph::set_unmeasured(std::size_t node, const Matrix6& covariance,
                                   LoopedDrift& result) {
  const Pose& T_map_known = graph_.T_map_node[node];
  const std::size_t submap = submap_of(node);
  for (std::size_t segment = 0; segment < segments_.size(); ++segment) {
    const bool was_unknown = segment > 0 && segments_[segment].submap == submap;
    if (was_unknown) result.segments.push_back({segment, T_map_known, covariance});
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (submap_of(i) != submap || segment_of(i) == 0) continue;
    const Pose motion = T_map_known.inverse() * graph_.T_map_node[i];
    nodes_[i].drift = {nodes_[i].drift.drift, carried(covariance, motion), false};
  }
}

std::vector<std::size_t> KeyframeGraph::submap_of_segment() const {
  std::vector<std::size_t> result;
  for (const Segment& segment : segments_) result.push_back(segment.submap);
  return result;
}

std::vector<SavedPlace> KeyframeGraph::places(std::size_t submap) const {
  std::vector<SavedPlace> result;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (submap_of(i) == submap) result.push_back({graph_.T_map_node[i], contexts_[i]});
  }
  return result;
}

std::vector<std::size_t> KeyframeGraph::older_nodes(std::size_t submap) const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const bool is_old =
        i < segments_.back().first_node || path_m_ - nodes_[i].path_m >= options_.recent_path_m;
    if (is_old && submap_of(i) == submap) result.push_back(i);
  }
  return result;
}

MapPoints KeyframeGraph::take_near_last() {
  const Surroundings place = loop_surroundings(T_map_last());
  const MapPoints still_near = taken_.take_near(place);
  MapPoints taken = submaps_[own_submap()].take_near(place);
  taken_ = FeatureMaps(options_);
  taken_.insert(still_near);
  taken_.insert(taken);
  return taken;
}

void KeyframeGraph::join(std::size_t submap, std::size_t other) {
  const auto [older, younger] = std::minmax(submap, other);
  submaps_[older].insert(submaps_[younger].take_all());
  for (Segment& segment : segments_) {
    if (segment.submap == younger) segment.submap = older;
  }
}

/// The poses of the keyframes of a segment that follow from those of its nodes.
std::vector<Pose> KeyframeGraph::moved(std::size_t segment,
                                       const std::vector<Pose>& T_map_node) const {
  const bool last = segment + 1 == segments_.size();
  const std::size_t begin = segments_[segment].first_keyframe;
  const std::size_t end = last ? T_map_keyframe_.size() : segments_[segment + 1].first_keyframe;
  const std::size_t begin_node = segments_[segment].first_node;
  const std::size_t end_node = last ? nodes_.size() : segments_[segment + 1].first_node;
  std::vector<std::uint32_t> keyframe_of_node;
  for (std::size_t i = begin_node; i < end_node; ++i) {
    keyframe_of_node.push_back(nodes_[i].keyframe - segments_[segment].first_keyframe);
  }
  return corrected_keyframes(std::span(T_map_keyframe_).subspan(begin, end - begin),
                             keyframe_of_node,
                             std::span(T_map_node).subspan(begin_node, end_node - begin_node));
}

std::vector<Pose> KeyframeGraph::move(const std::vector<Pose>& T_map_node) {
  std::vector<Pose> T_map_moved;
  for (std::size_t segment = 0; segment < segments_.size(); ++segment) {
    const std::vector<Pose> of_segment = moved(segment, T_map_node);
    T_map_moved.insert(T_map_moved.end(), of_segment.begin(), of_segment.end());
  }
  std::vector<Pose> corrections;
  for (std::size_t k = 0; k < T_map_moved.size(); ++k) {
    const bool stays = T_map_moved[k].matrix() == T_map_keyframe_[k].matrix();
    corrections.push_back(stays ? Pose::Identity()
                                : Pose(T_map_moved[k] * T_map_keyframe_[k].inverse()));
  }
  T_map_keyframe_ = std::move(T_map_moved);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    graph_.T_map_node[i] = T_map_keyframe_[nodes_[i].keyframe];
  }
  recent_.correct(corrections.back());
  for (FeatureMaps& submap : submaps_) submap.correct(corrections);
  taken_.correct(corrections);
  return corrections;
}

}  // namespace hqslam::slam
