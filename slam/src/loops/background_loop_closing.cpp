#include "loops/background_loop_closing.h"

#include <algorithm>
#include <utility>

#include "thread_limit.h"

namespace hqslam::slam {

namespace {

/// A second at the usual rate: longer than a search, and shorter than the path to the next one.
constexpr int kScansUntilDue = 10;

constexpr double kViewSpacing_m = 4.0;

}  // namespace

BackgroundLoopClosing::BackgroundLoopClosing(const MappingOptions& options, bool searches)
    : options_(options), loop_closing_(std::make_unique<LoopClosing>(options, searches)) {}

std::optional<LoopResult> BackgroundLoopClosing::collect() {
  if (!work_.valid() || --scans_until_due_ > 0) return std::nullopt;
  LoopResult result = collected();
  begin();
  return result;
}

std::optional<LoopResult> BackgroundLoopClosing::finish() {
  if (!work_.valid()) begin();
  if (!work_.valid()) return std::nullopt;
  return collected();
}

bool BackgroundLoopClosing::wants_view(const Pose& T_map_sensor) const {
  if (!T_map_last_) return true;
  return since_view_m_ + distance_m(T_map_sensor, *T_map_last_) >= kViewSpacing_m;
}

void BackgroundLoopClosing::add(LoopKeyframe keyframe) {
  if (T_map_last_) since_view_m_ += distance_m(keyframe.T_map_sensor, *T_map_last_);
  T_map_last_ = keyframe.T_map_sensor;
  if (keyframe.view) {
    since_view_m_ = 0.0;
    view_waits_ = true;
  }
  waiting_.push_back(std::move(keyframe));
  if (!work_.valid()) begin();
}

void BackgroundLoopClosing::begin() {
  if (!view_waits_) return;
  view_waits_ = false;
  keyframes_begun_ += waiting_.size();
  scans_until_due_ = kScansUntilDue;
  work_ = std::async(std::launch::async, [loop_closing = loop_closing_.get(),
                                          keyframes = std::exchange(waiting_, {})]() mutable {
            const ThreadLimit one_thread(1);
            return loop_closing->process(std::move(keyframes));
          }).share();
}

/// The result, with corrections for all keyframes: those added since the work began move with its
/// last one, until a segment begins.
LoopResult BackgroundLoopClosing::awaited() const {
  LoopResult result = work_.get();
  if (result.corrections.empty()) return result;
  for (const LoopKeyframe& keyframe : waiting_) {
    result.corrections.push_back(keyframe.begins_segment ? Pose(Pose::Identity())
                                                         : Pose(result.corrections.back()));
  }
  return result;
}

LoopResult BackgroundLoopClosing::collected() {
  LoopResult result = awaited();
  work_ = {};
  const auto lost = std::ranges::find_if(waiting_, &LoopKeyframe::begins_segment);
  std::optional<MapPoints> back;
  if (lost != waiting_.end()) back = std::exchange(result.restored, {});
  if (result.drift) {
    const Pose T_last_map = result.drift->T_map_last.inverse();
    for (LoopKeyframe& keyframe : waiting_) {
      const bool is_path_known = lost == waiting_.end() || &keyframe < &*lost;
      keyframe.drift = improved(keyframe.drift, result.drift->last,
                                T_last_map * keyframe.T_map_sensor, is_path_known);
    }
  }
  if (!result.corrections.empty()) {
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
      LoopKeyframe& keyframe = waiting_[i];
      const Pose& correction = result.corrections[keyframes_begun_ + i];
      keyframe.T_map_sensor = orthonormalized(correction * keyframe.T_map_sensor);
      if (keyframe.view) correct(keyframe.view->left_window, result.corrections);
    }
    T_map_last_ = orthonormalized(result.corrections.back() * *T_map_last_);
  }
  // The map in which they were to be matched has left the window.
  if (back) append(lost->view->left_window, *back);
  return result;
}

const KeyframeGraph& BackgroundLoopClosing::finished() const {
  if (work_.valid()) work_.wait();
  return loop_closing_->graph();
}

std::vector<FeatureMaps> BackgroundLoopClosing::whole_map(const FeatureMaps& matched_with) const {
  const LoopResult found = work_.valid() ? awaited() : LoopResult{};
  std::vector<FeatureMaps> submaps = loop_closing_->graph().submaps();
  const std::vector<std::size_t> submap_of_segment = loop_closing_->graph().submap_of_segment();
  std::size_t submap = submap_of_segment.empty() ? 0 : submap_of_segment.back();
  if (submap < submaps.size()) submaps[submap].insert(found.restored);
  const auto add = [&](MapPoints points) {
    if (!found.corrections.empty()) correct(points, found.corrections);
    if (submap < submaps.size()) submaps[submap].insert(points);
  };
  for (const LoopKeyframe& keyframe : waiting_) {
    if (keyframe.view) add(keyframe.view->left_window);
    if (!keyframe.begins_segment) continue;
    submap = submaps.size();
    submaps.emplace_back(options_);
  }
  add(FeatureMaps(matched_with).take_all());
  return submaps;
}

}  // namespace hqslam::slam
