#include "loops/loop_closing.h"

#include <algorithm>
#include <utility>

#include "loops/loop_correction.h"

namespace hqslam::slam {

namespace {

// Spacing of searches, in metres of path.
constexpr double kSearchEvery_m = 8.0;
constexpr double kSearchAfterFailing_m = 16.0;
constexpr double kSearchAfterAgreeing_m = 20.0;
constexpr double kSearchAfterImplausible_m = 50.0;

/// A loop that moves the pose by less is within the accuracy of a registration.
constexpr double kAgreeing_m = 0.15;
constexpr double kAgreeing_rad = 0.01;

/// Accuracy with which scans are matched with the map (simulated drives alone).
constexpr double kAligned_m = 0.01;
constexpr double kAligned_rad = 0.001;

// Agreement of loops, and their number and length of path. The length exceeds the correction: two
// places that are similar over a length L are at least L apart, or they would overlap, so a false
// loop between them would move the path by more than the length over which it is confirmed.
constexpr double kConsistent_m = 0.3;
constexpr double kConsistent_rad = 0.02;
constexpr std::size_t kLoopsWanted = 3;
constexpr double kLengthBeyondCorrection_m = 12.0;
constexpr int kMaxMissed = 2;

// Sigmas of a loop's edge.
constexpr double kLoopSigma_m = 0.03;
constexpr double kLoopSigma_rad = 0.002;

}  // namespace

LoopResult LoopClosing::process(std::vector<LoopKeyframe> keyframes) {
  for (LoopKeyframe& keyframe : keyframes) {
    // The points that left the window belong to the segment before this keyframe.
    const bool is_first = graph_.submaps().empty();
    if (keyframe.view && !is_first) graph_.insert(keyframe.view->left_window);
    graph_.add_keyframe(keyframe);
    if (is_first || keyframe.begins_segment) {
      forget_waiting();
      next_search_m_ = graph_.path_m();
    }
    if (keyframe.view && (searches_ || keyframe.is_inertial)) graph_.add_node(keyframe);
  }
  LoopResult result;
  const bool is_levelled = graph_.level();
  if (searches_ && !graph_.empty() && graph_.path_m() >= next_search_m_) result = search();
  if (is_levelled && result.corrections.empty()) stand_upright(result);
  result.submap_of_segment = graph_.submap_of_segment();
  result.gravity_contradicts = graph_.gravity_contradicts();
  return result;
}

LoopResult LoopClosing::search() {
  LoopResult result;
  LoopReport& report = result.report;
  report = waiting_.empty() ? look_around() : look_where_predicted();
  report.scan = graph_.scan_of(graph_.last());
  if (report.status == LoopStatus::kAgrees || enough_agree()) close(result);
  if (report.status == LoopStatus::kAgrees || report.status == LoopStatus::kClosed) {
    result.restored = graph_.take_near_last();
  }
  return result;
}

/// Searches for the last node in a submap.
template <typename Look>
auto LoopClosing::look_in(std::size_t submap, const Look& look) const {
  const std::vector<std::size_t> nodes = graph_.older_nodes(submap);
  const std::vector<PlausibleDrift> drift = plausible_drift(graph_.poses(), graph_.edge_drift_m());
  const MapFeatures features = graph_.features_about_last();
  return look(LoopSearchSpace{options_, graph_.submaps()[submap], graph_.poses(), graph_.contexts(),
                              graph_.last_contexts(), drift, features, nodes,
                              submap == graph_.own_submap() ? &graph_.taken() : nullptr});
}

/// The other submaps come first, because a loop there gains most.
LoopReport LoopClosing::look_around() {
  LoopSearchResult found;
  const std::size_t own = graph_.own_submap();
  for (std::size_t submap = 0; submap < graph_.submaps().size() && !found.loop; ++submap) {
    if (submap != own) found = look_in(submap, search_similar_places);
  }
  if (!found.loop) found = look_in(own, search_loop);
  const bool failed = found.candidates > 0 && !found.loop;
  next_search_m_ = graph_.path_m() + (failed ? kSearchAfterFailing_m : kSearchEvery_m);
  LoopReport report;
  report.status = found.status;
  report.candidates = found.candidates;
  if (!found.loop) return report;
  report.older_scan = graph_.scan_of(found.loop->node);
  const Pose change = graph_.T_map_last().inverse() * found.loop->T_map_last;
  if (graph_.submap_of(found.loop->node) == own && is_within(change, kAgreeing_m, kAgreeing_rad)) {
    report.status = LoopStatus::kAgrees;
  }
  await_others(*found.loop);
  return report;
}

LoopReport LoopClosing::look_where_predicted() {
  const Pose T_map_predicted = T_corrected_map(waiting_.back()) * graph_.T_map_last();
  const std::optional<FoundLoop> loop =
      look_in(graph_.submap_of(waiting_.back().from),
              [&](const LoopSearchSpace& space) { return loop_at(space, T_map_predicted); });
  LoopReport report;
  report.candidates = 1;
  report.status = LoopStatus::kNotVerified;
  if (loop &&
      is_within(T_map_predicted.inverse() * loop->T_map_last, kConsistent_m, kConsistent_rad)) {
    report.status = LoopStatus::kAwaitsOthers;
    report.older_scan = graph_.scan_of(loop->node);
    await_others(*loop);
  } else if (++missed_ >= kMaxMissed) {
    forget_waiting();
    next_search_m_ = graph_.path_m() + kSearchEvery_m;
  }
  return report;
}

/// The correction of a loop's younger node by the loop.
Pose LoopClosing::T_corrected_map(const PoseGraphEdge& loop) const {
  const std::vector<Pose>& T_map_node = graph_.poses().T_map_node;
  return T_map_node[loop.from] * loop.T_from_to * T_map_node[loop.to].inverse();
}

void LoopClosing::await_others(const FoundLoop& loop) {
  const Pose& T_map_older = graph_.poses().T_map_node[loop.node];
  waiting_.push_back({loop.node, graph_.last(), T_map_older.inverse() * loop.T_map_last,
                      kLoopSigma_m, kLoopSigma_rad});
  missed_ = 0;
}

void LoopClosing::forget_waiting() {
  waiting_.clear();
  missed_ = 0;
}

bool LoopClosing::enough_agree() const {
  if (waiting_.size() < kLoopsWanted) return false;
  const PoseGraphEdge& last = waiting_.back();
  const double length_m = graph_.path_m(last.to) - graph_.path_m(waiting_.front().to);
  if (graph_.submap_of(last.from) != graph_.submap_of(last.to)) {
    return length_m >= kLengthBeyondCorrection_m;
  }
  const Eigen::Vector3d estimated_m = graph_.poses().T_map_node[last.to].translation();
  const double change_m = (T_corrected_map(last) * estimated_m - estimated_m).norm();
  return length_m >= kLengthBeyondCorrection_m + change_m;
}

/// Accepts the waiting loops and bends the path onto them if that is plausible. A correction below
/// the accuracy of matching is left out. A larger one, even within the accuracy of a registration,
/// is applied: two copies of a street side by side would attract the sensor alternately.
void LoopClosing::close(LoopResult& result) {
  LoopReport& report = result.report;
  const bool agrees = report.status == LoopStatus::kAgrees;
  const std::vector<PoseGraphEdge> loops = std::exchange(waiting_, {});
  forget_waiting();
  const PoseGraphEdge& last = loops.back();
  next_search_m_ = graph_.path_m() + kSearchAfterAgreeing_m;
  const Pose residual = disagreement(last, graph_.poses().T_map_node);
  if (agrees && is_within(residual, kAligned_m, kAligned_rad)) {
    graph_.add_loops(loops);
    result.drift = graph_.improve_drift(last);
    return;
  }
  PoseGraph with_loops = graph_.poses();
  with_loops.loops.insert(with_loops.loops.end(), loops.begin(), loops.end());
  const std::size_t submap = graph_.submap_of(last.to);
  const std::size_t other = graph_.submap_of(last.from);
  if (submap != other) bring_together(with_loops, last);
  const std::vector<Pose> T_map_node = optimized(with_loops);
  if (T_map_node.empty() || !is_plausible(with_loops, graph_.edge_drift_m(), T_map_node)) {
    report.status = LoopStatus::kImplausible;
    next_search_m_ = graph_.path_m() + kSearchAfterImplausible_m;
    return;
  }
  if (!agrees) report.status = LoopStatus::kClosed;
  graph_.add_loops(loops);
  result.drift = graph_.improve_drift(last);
  move(T_map_node, result);
  if (submap != other) graph_.join(submap, other);
}

void LoopClosing::move(const std::vector<Pose>& T_map_node, LoopResult& result) {
  result.report.correction_m = distance_m(T_map_node.back(), graph_.T_map_last());
  result.corrections = graph_.move(T_map_node);
}

/// Moves the path to its levelled edges, and the restored points with it.
void LoopClosing::stand_upright(LoopResult& result) {
  const std::vector<Pose> T_map_node = optimized(graph_.poses());
  if (T_map_node.empty()) return;
  move(T_map_node, result);
  correct(result.restored, result.corrections);
}

/// Moves the younger of two submaps as a whole by a loop, as a start of the optimisation.
void LoopClosing::bring_together(PoseGraph& graph, const PoseGraphEdge& loop) const {
  const std::size_t submap = graph_.submap_of(loop.to);
  const std::size_t other = graph_.submap_of(loop.from);
  const Pose move = submap > other ? T_corrected_map(loop) : T_corrected_map(loop).inverse();
  for (std::size_t i = 0; i < graph.T_map_node.size(); ++i) {
    if (graph_.submap_of(i) != std::max(submap, other)) continue;
    graph.T_map_node[i] = orthonormalized(move * graph.T_map_node[i]);
  }
}

}  // namespace hqslam::slam
