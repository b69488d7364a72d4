#include "loops/loop_closing.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "loops/loop_correction.h"

namespace hqslam::slam {

namespace {

// How often is looked for loops, in metres of path.
constexpr double kSearchEvery_m = 8.0;
constexpr double kSearchAfterFailing_m = 16.0;
constexpr double kSearchAfterAgreeing_m = 20.0;
constexpr double kSearchAfterImplausible_m = 50.0;

/// A loop that would move the pose by less is within the accuracy of a registration.
constexpr double kAgreeing_m = 0.15;
constexpr double kAgreeing_rad = 0.01;

/// Scans are matched with the map to so much.
constexpr double kAligned_m = 0.01;
constexpr double kAligned_rad = 0.001;

// When loops agree with each other, and how many are wanted over which stretch. The stretch is so
// much longer than the correction: two places that look alike over a stretch of L are at least L
// apart, or they would overlap, so a false loop between them would move the path by more than the
// stretch over which it is confirmed.
constexpr double kConsistent_m = 0.3;
constexpr double kConsistent_rad = 0.02;
constexpr std::size_t kLoopsWanted = 3;
constexpr double kStretchBeyondCorrection_m = 12.0;
constexpr int kMaxMissed = 2;

// Drift of scan-to-map matching as a share of the path, at the most.
constexpr double kDriftShare = 0.03;
constexpr double kDriftShareUnobserved = 0.3;

// Sigmas of edges.
constexpr double kLoopSigma_m = 0.03;
constexpr double kLoopSigma_rad = 0.002;
constexpr double kLeastSigma_m = 0.01;
constexpr double kLeastSigma_rad = 0.001;
constexpr double kSigmaPerDrift = 1.0 / 3.0;
constexpr double kSigma_rad_per_m = 0.005;

bool is_within(const Pose& change, double max_m, double max_rad) {
  return change.translation().norm() <= max_m && rotation_angle_rad(change) <= max_rad;
}

}  // namespace

LoopClosing::LoopClosing(const MappingOptions& mapping, bool searches)
    : mapping_(mapping), searches_(searches) {}

LoopResult LoopClosing::process(std::vector<LoopKeyframe> keyframes) {
  for (LoopKeyframe& keyframe : keyframes) {
    // What was laid aside belongs to the stretch before this keyframe.
    if (keyframe.view && !submaps_.empty()) {
      submaps_[segments_.back().part].insert(keyframe.view->left_window);
    }
    add_keyframe(keyframe);
    if (keyframe.view && searches_) add_node(keyframe);
  }
  LoopResult result;
  if (searches_ && !nodes_.empty() && path_m_ >= next_search_m_) result = search();
  result.submap_of_segment = submap_of_segment();
  return result;
}

std::vector<std::size_t> LoopClosing::submap_of_segment() const {
  std::vector<std::size_t> result;
  for (const Segment& stretch : segments_) result.push_back(stretch.part);
  return result;
}

std::vector<SavedPlace> LoopClosing::places(std::size_t part) const {
  std::vector<SavedPlace> result;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (submap_of(i) == part) result.push_back({graph_.T_map_node[i], contexts_[i]});
  }
  return result;
}

void LoopClosing::add_keyframe(const LoopKeyframe& keyframe) {
  if (T_map_keyframe_.empty() || keyframe.begins_segment) {
    segments_.push_back(
        {static_cast<std::uint32_t>(T_map_keyframe_.size()), nodes_.size(), submaps_.size()});
    submaps_.emplace_back(mapping_);
    recent_ = RecentFeatures(kRecentNodes);
    forget_waiting();
    next_search_m_ = path_m_;
    drift_m_ = 0.0;
  } else {
    const double step_m =
        (keyframe.T_map_sensor.translation() - T_map_keyframe_.back().translation()).norm();
    const bool observed =
        keyframe.mapping_status == Status::kOk || keyframe.mapping_status == Status::kNotConverged;
    path_m_ += step_m;
    drift_m_ += (observed ? kDriftShare : kDriftShareUnobserved) * step_m;
  }
  T_map_keyframe_.push_back(keyframe.T_map_sensor);
}

void LoopClosing::add_node(const LoopKeyframe& keyframe) {
  if (nodes_.size() > segments_.back().first_node) {
    const double sigma_m = kSigmaPerDrift * drift_m_;
    graph_.odometry.push_back({nodes_.size() - 1, nodes_.size(),
                               graph_.T_map_node.back().inverse() * keyframe.T_map_sensor,
                               kLeastSigma_m + sigma_m,
                               kLeastSigma_rad + kSigma_rad_per_m * sigma_m});
    edge_drift_m_.push_back(drift_m_);
  }
  drift_m_ = 0.0;
  graph_.T_map_node.push_back(keyframe.T_map_sensor);
  nodes_.push_back(
      {static_cast<std::uint32_t>(T_map_keyframe_.size() - 1), keyframe.scan, path_m_});
  last_contexts_ = scan_contexts_from_lanes(keyframe.view->cloud);
  contexts_.push_back(last_contexts_.front());
  recent_.add(keyframe.view->features, keyframe.T_map_sensor, keyframe.view->velocity);
}

std::size_t LoopClosing::submap_of(std::size_t node) const {
  const auto begins_after = [](std::size_t i, const Segment& stretch) {
    return i < stretch.first_node;
  };
  return std::prev(std::upper_bound(segments_.begin(), segments_.end(), node, begins_after))->part;
}

/// The nodes of a part; of the last stretch those about which the map was laid aside.
std::vector<std::size_t> LoopClosing::nodes_to_ask(std::size_t part) const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const bool is_old =
        i < segments_.back().first_node || path_m_ - nodes_[i].path_m >= mapping_.recent_path_m;
    if (is_old && submap_of(i) == part) result.push_back(i);
  }
  return result;
}

/// What is found of the last node in a part of the map.
template <typename Look>
auto LoopClosing::look_in(std::size_t part, const Look& look) const {
  const std::vector<std::size_t> nodes = nodes_to_ask(part);
  const std::vector<PlausibleDrift> drift = plausible_drift(graph_, edge_drift_m_);
  const MapFeatures features = recent_.about_last();
  return look(LoopSearchSpace{mapping_, submaps_[part], graph_, contexts_, last_contexts_, drift,
                              features, nodes});
}

LoopResult LoopClosing::search() {
  LoopResult result;
  result.report = waiting_.empty() ? look_around() : look_where_predicted();
  result.report.scan = nodes_.back().scan;
  if (enough_agree()) {
    result.corrections = close(result.report);
  } else if (result.report.status == LoopStatus::kAgrees) {
    result.corrections = align(result.report);
  }
  if (result.report.status == LoopStatus::kAgrees || result.report.status == LoopStatus::kClosed) {
    result.recalled =
        submaps_[segments_.back().part].take_near(loop_surroundings(graph_.T_map_node.back()));
  }
  return result;
}

/// In the other parts first: that is where most is to be won.
LoopReport LoopClosing::look_around() {
  LoopSearchResult found;
  const std::size_t own = segments_.back().part;
  for (std::size_t part = 0; part < submaps_.size() && !found.loop; ++part) {
    if (part != own) found = look_in(part, search_similar_places);
  }
  if (!found.loop) found = look_in(own, search_loop);
  const bool failed = found.candidates > 0 && !found.loop;
  next_search_m_ = path_m_ + (failed ? kSearchAfterFailing_m : kSearchEvery_m);
  LoopReport report;
  report.status = found.status;
  report.candidates = found.candidates;
  if (!found.loop) return report;
  report.older_scan = nodes_[found.loop->node].scan;
  const Pose change = graph_.T_map_node.back().inverse() * found.loop->T_map_last;
  if (submap_of(found.loop->node) == own && is_within(change, kAgreeing_m, kAgreeing_rad)) {
    graph_.loops.push_back(edge_of(*found.loop));
    next_search_m_ = path_m_ + kSearchAfterAgreeing_m;
    report.status = LoopStatus::kAgrees;
  } else {
    await_others(*found.loop);
  }
  return report;
}

LoopReport LoopClosing::look_where_predicted() {
  const Pose T_map_predicted = T_corrected_map_ * graph_.T_map_node.back();
  const std::optional<FoundLoop> loop =
      look_in(submap_of(waiting_.back().from),
              [&](const LoopSearchSpace& space) { return loop_at(space, T_map_predicted); });
  LoopReport report;
  report.candidates = 1;
  report.status = LoopStatus::kNotVerified;
  if (loop &&
      is_within(T_map_predicted.inverse() * loop->T_map_last, kConsistent_m, kConsistent_rad)) {
    report.status = LoopStatus::kAwaitsOthers;
    report.older_scan = nodes_[loop->node].scan;
    await_others(*loop);
  } else if (++missed_ >= kMaxMissed) {
    forget_waiting();
    next_search_m_ = path_m_ + kSearchEvery_m;
  }
  return report;
}

PoseGraphEdge LoopClosing::edge_of(const FoundLoop& loop) const {
  return {loop.node, nodes_.size() - 1, graph_.T_map_node[loop.node].inverse() * loop.T_map_last,
          kLoopSigma_m, kLoopSigma_rad};
}

void LoopClosing::await_others(const FoundLoop& loop) {
  waiting_.push_back(edge_of(loop));
  T_corrected_map_ = loop.T_map_last * graph_.T_map_node.back().inverse();
  missed_ = 0;
}

void LoopClosing::forget_waiting() {
  waiting_.clear();
  missed_ = 0;
}

bool LoopClosing::enough_agree() const {
  if (waiting_.size() < kLoopsWanted) return false;
  const double stretch_m = nodes_[waiting_.back().to].path_m - nodes_[waiting_.front().to].path_m;
  const bool joins = submap_of(waiting_.back().from) != submap_of(waiting_.back().to);
  if (joins) return stretch_m >= kStretchBeyondCorrection_m;
  const Eigen::Vector3d believed_m = graph_.T_map_node[waiting_.back().to].translation();
  const double correction_m = (T_corrected_map_ * believed_m - believed_m).norm();
  return stretch_m >= kStretchBeyondCorrection_m + correction_m;
}

/// The place is where it is believed to be, but for the accuracy of a registration. Where that is
/// more than what scans are matched to, the path is bent onto it: two copies of a street side by
/// side would pull the sensor to and fro.
std::vector<Pose> LoopClosing::align(LoopReport& report) {
  const Pose off = disagreement(graph_.loops.back(), graph_.T_map_node);
  if (is_within(off, kAligned_m, kAligned_rad)) return {};
  const std::vector<Pose> T_map_node = optimized(graph_);
  if (T_map_node.empty() || !is_plausible(graph_, edge_drift_m_, T_map_node)) return {};
  report.correction_m =
      (T_map_node.back().translation() - graph_.T_map_node.back().translation()).norm();
  return move_keyframes(T_map_node);
}

std::vector<Pose> LoopClosing::close(LoopReport& report) {
  PoseGraph with_loops = graph_;
  with_loops.loops.insert(with_loops.loops.end(), waiting_.begin(), waiting_.end());
  bring_together(with_loops);
  const std::size_t part = submap_of(waiting_.back().to);
  const std::size_t other = submap_of(waiting_.back().from);
  forget_waiting();
  const std::vector<Pose> T_map_node = optimized(with_loops);
  if (T_map_node.empty() || !is_plausible(with_loops, edge_drift_m_, T_map_node)) {
    report.status = LoopStatus::kImplausible;
    next_search_m_ = path_m_ + kSearchAfterImplausible_m;
    return {};
  }
  graph_.loops = std::move(with_loops.loops);
  report.status = LoopStatus::kClosed;
  report.correction_m =
      (T_map_node.back().translation() - graph_.T_map_node.back().translation()).norm();
  next_search_m_ = path_m_ + kSearchAfterAgreeing_m;
  std::vector<Pose> corrections = move_keyframes(T_map_node);
  if (part != other) join(part, other);
  return corrections;
}

/// Puts the younger of two parts where the loops see it, as a whole: the optimisation begins there.
void LoopClosing::bring_together(PoseGraph& graph) const {
  const std::size_t part = submap_of(waiting_.back().to);
  const std::size_t other = submap_of(waiting_.back().from);
  const Pose move = part > other ? T_corrected_map_ : Pose(T_corrected_map_.inverse());
  for (std::size_t i = 0; i < nodes_.size() && part != other; ++i) {
    if (submap_of(i) != std::max(part, other)) continue;
    graph.T_map_node[i] = orthonormalized(move * graph.T_map_node[i]);
  }
}

/// Of two parts that are in one frame now the younger becomes one with the older.
void LoopClosing::join(std::size_t part, std::size_t other) {
  const auto [older, younger] = std::minmax(part, other);
  submaps_[older].insert(submaps_[younger].take_all());
  for (Segment& stretch : segments_) {
    if (stretch.part == younger) stretch.part = older;
  }
}

/// The poses that the keyframes of a stretch get from those of its nodes.
std::vector<Pose> LoopClosing::corrected(std::size_t stretch,
                                         const std::vector<Pose>& T_map_node) const {
  const bool last = stretch + 1 == segments_.size();
  const std::size_t begin = segments_[stretch].first_keyframe;
  const std::size_t end = last ? T_map_keyframe_.size() : segments_[stretch + 1].first_keyframe;
  const std::size_t begin_node = segments_[stretch].first_node;
  const std::size_t end_node = last ? nodes_.size() : segments_[stretch + 1].first_node;
  std::vector<std::uint32_t> keyframe_of_node;
  for (std::size_t i = begin_node; i < end_node; ++i) {
    keyframe_of_node.push_back(nodes_[i].keyframe - segments_[stretch].first_keyframe);
  }
  const auto piece = [](const std::vector<Pose>& poses, std::size_t from, std::size_t to) {
    return std::vector<Pose>(poses.begin() + static_cast<std::ptrdiff_t>(from),
                             poses.begin() + static_cast<std::ptrdiff_t>(to));
  };
  return corrected_keyframes(piece(T_map_keyframe_, begin, end), keyframe_of_node,
                             piece(T_map_node, begin_node, end_node));
}

/// Every stretch of path, and what was laid aside of it, moves with its nodes.
std::vector<Pose> LoopClosing::move_keyframes(const std::vector<Pose>& T_map_node) {
  std::vector<Pose> moved;
  for (std::size_t stretch = 0; stretch < segments_.size(); ++stretch) {
    const std::vector<Pose> of_segment = corrected(stretch, T_map_node);
    moved.insert(moved.end(), of_segment.begin(), of_segment.end());
  }
  std::vector<Pose> corrections;
  for (std::size_t k = 0; k < moved.size(); ++k) {
    const bool stays = moved[k].matrix() == T_map_keyframe_[k].matrix();
    corrections.push_back(stays ? Pose::Identity() : Pose(moved[k] * T_map_keyframe_[k].inverse()));
  }
  T_map_keyframe_ = std::move(moved);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    graph_.T_map_node[i] = T_map_keyframe_[nodes_[i].keyframe];
  }
  recent_.correct(corrections.back());
  for (FeatureMaps& part : submaps_) part.correct(corrections);
  return corrections;
}

}  // namespace hqslam::slam
