#include "loops/loop_closing.h"

#include <algorithm>

#include "loops/loop_correction.h"

namespace hqslam::slam {

namespace {

constexpr double kNodeSpacing_m = 4.0;
/// Path after which a place counts as passed before.
constexpr double kMinPath_m = 50.0;
constexpr double kRecentRadius_m = 35.0;
constexpr std::size_t kRecentPoints = 800;  // of each kind

// How often is looked for loops, in metres of path.
constexpr double kSearchEvery_m = 8.0;
constexpr double kSearchAfterFailing_m = 16.0;
constexpr double kSearchAfterAgreeing_m = 20.0;
constexpr double kSearchAfterImplausible_m = 50.0;

/// A loop that would move the pose by less is within the accuracy of a registration.
constexpr double kAgreeing_m = 0.15;
constexpr double kAgreeing_rad = 0.01;

/// Scans are matched with the map to so much.
constexpr double kAligned_m = 0.02;
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

LoopResult LoopClosing::process(const LoopKeyFrame& key_frame, const Mapping& mapping) {
  add_key_frame(key_frame);
  if (!nodes_.empty() && path_m_ - nodes_.back().path_m < kNodeSpacing_m) return {};
  add_node(key_frame);
  if (path_m_ < next_search_m_) return {};
  return search(mapping);
}

std::vector<SavedPlace> LoopClosing::places() const {
  std::vector<SavedPlace> result;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    result.push_back({graph_.T_map_node[i], contexts_[i]});
  }
  return result;
}

void LoopClosing::add_key_frame(const LoopKeyFrame& key_frame) {
  if (!T_map_key_frame_.empty()) {
    const double step_m =
        (key_frame.T_map_sensor.translation() - T_map_key_frame_.back().translation()).norm();
    const bool observed = key_frame.mapping_status == Status::kOk ||
                          key_frame.mapping_status == Status::kNotConverged;
    path_m_ += step_m;
    drift_m_ += (observed ? kDriftShare : kDriftShareUnobserved) * step_m;
  }
  T_map_key_frame_.push_back(key_frame.T_map_sensor);
}

void LoopClosing::add_node(const LoopKeyFrame& key_frame) {
  if (!nodes_.empty()) {
    const double sigma_m = kSigmaPerDrift * drift_m_;
    graph_.odometry.push_back({nodes_.size() - 1, nodes_.size(),
                               graph_.T_map_node.back().inverse() * key_frame.T_map_sensor,
                               kLeastSigma_m + sigma_m,
                               kLeastSigma_rad + kSigma_rad_per_m * sigma_m});
    edge_drift_m_.push_back(drift_m_);
  }
  drift_m_ = 0.0;
  graph_.T_map_node.push_back(key_frame.T_map_sensor);
  nodes_.push_back(
      {static_cast<std::uint32_t>(T_map_key_frame_.size() - 1), key_frame.scan, path_m_});
  last_contexts_ = scan_contexts_from_lanes(key_frame.cloud);
  contexts_.push_back(last_contexts_.front());
  recent_.add(key_frame.features, key_frame.T_map_sensor, key_frame.velocity);
}

LoopResult LoopClosing::search(const Mapping& mapping) {
  const auto is_old = [&](const Node& node) { return path_m_ - node.path_m >= kMinPath_m; };
  const auto first_new = std::partition_point(nodes_.begin(), nodes_.end(), is_old);
  LoopResult result;
  if (first_new == nodes_.begin()) return result;
  const std::vector<PlausibleDrift> drift = plausible_drift(graph_, edge_drift_m_);
  const MapFeatures features = recent_.about_last(kRecentRadius_m, kRecentPoints);
  const LoopSearchSpace space{mapping,
                              graph_,
                              contexts_,
                              last_contexts_,
                              drift,
                              features,
                              static_cast<std::size_t>(first_new - nodes_.begin()),
                              std::prev(first_new)->key_frame + 1};
  result.report = waiting_.empty() ? look_around(space) : look_where_predicted(space);
  if (enough_agree()) {
    result.corrections = close(result.report);
  } else if (result.report.status == LoopStatus::kAgrees) {
    result.corrections = align(result.report);
  }
  return result;
}

LoopReport LoopClosing::look_around(const LoopSearchSpace& space) {
  const LoopSearchResult found = search_loop(space);
  const bool failed = found.candidates > 0 && !found.loop;
  next_search_m_ = path_m_ + (failed ? kSearchAfterFailing_m : kSearchEvery_m);
  LoopReport report;
  report.status = found.status;
  report.candidates = found.candidates;
  if (!found.loop) return report;
  report.older_scan = nodes_[found.loop->node].scan;
  const Pose change = graph_.T_map_node.back().inverse() * found.loop->T_map_last;
  if (is_within(change, kAgreeing_m, kAgreeing_rad)) {
    graph_.loops.push_back(edge_of(*found.loop));
    next_search_m_ = path_m_ + kSearchAfterAgreeing_m;
    report.status = LoopStatus::kAgrees;
  } else {
    await_others(*found.loop);
  }
  return report;
}

LoopReport LoopClosing::look_where_predicted(const LoopSearchSpace& space) {
  const Pose T_map_predicted = T_corrected_map_ * graph_.T_map_node.back();
  const std::optional<FoundLoop> loop = loop_at(space, T_map_predicted);
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
  const Eigen::Vector3d believed_m = graph_.T_map_node[waiting_.back().to].translation();
  const double correction_m = (T_corrected_map_ * believed_m - believed_m).norm();
  const double stretch_m = nodes_[waiting_.back().to].path_m - nodes_[waiting_.front().to].path_m;
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
  return move_key_frames(T_map_node);
}

std::vector<Pose> LoopClosing::close(LoopReport& report) {
  PoseGraph with_loops = graph_;
  with_loops.loops.insert(with_loops.loops.end(), waiting_.begin(), waiting_.end());
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
  return move_key_frames(T_map_node);
}

std::vector<Pose> LoopClosing::move_key_frames(const std::vector<Pose>& T_map_node) {
  std::vector<std::uint32_t> key_frame_of_node;
  for (const Node& node : nodes_) key_frame_of_node.push_back(node.key_frame);
  const std::vector<Pose> moved =
      corrected_key_frames(T_map_key_frame_, key_frame_of_node, T_map_node);
  std::vector<Pose> corrections;
  for (std::size_t k = 0; k < moved.size(); ++k) {
    const bool stays = moved[k].matrix() == T_map_key_frame_[k].matrix();
    corrections.push_back(stays ? Pose::Identity()
                                : Pose(moved[k] * T_map_key_frame_[k].inverse()));
  }
  T_map_key_frame_ = moved;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    graph_.T_map_node[i] = moved[nodes_[i].key_frame];
  }
  recent_.correct(corrections.back());
  return corrections;
}

}  // namespace hqslam::slam
