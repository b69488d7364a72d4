#include "loops/background_loop_closing.h"

#include <algorithm>
#include <utility>

#include "thread_limit.h"

namespace hqslam::slam {

namespace {

/// A second at the usual rate: more than a search takes, and less than the path to the next one.
constexpr int kScansUntilDue = 10;

constexpr double kViewSpacing_m = 4.0;

}  // namespace

BackgroundLoopClosing::BackgroundLoopClosing(const MappingOptions& mapping, bool searches)
    : mapping_(mapping), loop_closing_(std::make_unique<LoopClosing>(mapping, searches)) {}

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
  const double step_m = (T_map_sensor.translation() - T_map_last_->translation()).norm();
  return since_view_m_ + step_m >= kViewSpacing_m;
}

void BackgroundLoopClosing::add(LoopKeyFrame key_frame) {
  if (T_map_last_) {
    since_view_m_ += (key_frame.T_map_sensor.translation() - T_map_last_->translation()).norm();
  }
  T_map_last_ = key_frame.T_map_sensor;
  if (key_frame.view) {
    since_view_m_ = 0.0;
    view_waits_ = true;
  }
  waiting_.push_back(std::move(key_frame));
  if (!work_.valid()) begin();
}

void BackgroundLoopClosing::begin() {
  if (!view_waits_) return;
  view_waits_ = false;
  key_frames_begun_ += waiting_.size();
  scans_until_due_ = kScansUntilDue;
  work_ = std::async(std::launch::async, [loop_closing = loop_closing_.get(),
                                          key_frames = std::exchange(waiting_, {})]() mutable {
            const ThreadLimit one_thread(1);
            return loop_closing->process(std::move(key_frames));
          }).share();
}

/// What was found out, with corrections for all key frames: those since the work was begun move
/// with the last one of it, up to where the way was lost.
LoopResult BackgroundLoopClosing::awaited() const {
  LoopResult result = work_.get();
  if (result.corrections.empty()) return result;
  for (const LoopKeyFrame& key_frame : waiting_) {
    result.corrections.push_back(key_frame.begins_stretch ? Pose(Pose::Identity())
                                                          : Pose(result.corrections.back()));
  }
  return result;
}

LoopResult BackgroundLoopClosing::collected() {
  LoopResult result = awaited();
  work_ = {};
  const auto lost = std::find_if(waiting_.begin(), waiting_.end(),
                                 [](const LoopKeyFrame& frame) { return frame.begins_stretch; });
  std::optional<MapPoints> back;
  if (lost != waiting_.end()) back = std::exchange(result.recalled, {});
  if (!result.corrections.empty()) {
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
      LoopKeyFrame& key_frame = waiting_[i];
      const Pose& correction = result.corrections[key_frames_begun_ + i];
      key_frame.T_map_sensor = orthonormalized(correction * key_frame.T_map_sensor);
      if (key_frame.view) correct(key_frame.view->laid_aside, result.corrections);
    }
    T_map_last_ = orthonormalized(result.corrections.back() * *T_map_last_);
  }
  // The map that they were to be matched in was laid aside meanwhile.
  if (back) append(lost->view->laid_aside, *back);
  return result;
}

const LoopClosing& BackgroundLoopClosing::finished() const {
  if (work_.valid()) work_.wait();
  return *loop_closing_;
}

std::vector<FeatureMaps> BackgroundLoopClosing::whole_map(const FeatureMaps& matched_with) const {
  const LoopResult found = work_.valid() ? awaited() : LoopResult{};
  std::vector<FeatureMaps> parts = loop_closing_->parts();
  const std::vector<std::size_t> part_of_stretch = loop_closing_->part_of_stretch();
  std::size_t part = part_of_stretch.empty() ? 0 : part_of_stretch.back();
  if (part < parts.size()) parts[part].insert(found.recalled);
  const auto add = [&](MapPoints points) {
    if (!found.corrections.empty()) correct(points, found.corrections);
    if (part < parts.size()) parts[part].insert(points);
  };
  for (const LoopKeyFrame& key_frame : waiting_) {
    if (key_frame.view) add(key_frame.view->laid_aside);
    if (!key_frame.begins_stretch) continue;
    part = parts.size();
    parts.emplace_back(mapping_);
  }
  add(FeatureMaps(matched_with).take_all());
  return parts;
}

}  // namespace hqslam::slam
