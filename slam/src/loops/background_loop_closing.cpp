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
    : loop_closing_(std::make_unique<LoopClosing>(mapping, searches)) {}

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

/// Key frames since the work was begun move with the last one of it, up to where the way was lost.
std::vector<Pose> BackgroundLoopClosing::for_all(std::vector<Pose> corrections) const {
  if (corrections.empty()) return corrections;
  for (const LoopKeyFrame& key_frame : waiting_) {
    corrections.push_back(key_frame.begins_stretch ? Pose::Identity() : corrections.back());
  }
  return corrections;
}

LoopResult BackgroundLoopClosing::collected() {
  LoopResult result = work_.get();
  work_ = {};
  const auto lost = std::find_if(waiting_.begin(), waiting_.end(),
                                 [](const LoopKeyFrame& frame) { return frame.begins_stretch; });
  if (lost != waiting_.end()) {
    // The map that they were to be matched in was laid aside meanwhile.
    append(lost->view->laid_aside, std::exchange(result.recalled, {}));
  }
  result.corrections = for_all(std::move(result.corrections));
  if (result.corrections.empty()) return result;
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    LoopKeyFrame& key_frame = waiting_[i];
    const Pose& correction = result.corrections[key_frames_begun_ + i];
    key_frame.T_map_sensor = orthonormalized(correction * key_frame.T_map_sensor);
    if (key_frame.view) correct(key_frame.view->laid_aside, result.corrections);
  }
  T_map_last_ = orthonormalized(result.corrections.back() * *T_map_last_);
  return result;
}

const LoopClosing& BackgroundLoopClosing::finished() const {
  if (work_.valid()) work_.wait();
  return *loop_closing_;
}

std::optional<LoopResult> BackgroundLoopClosing::pending() const {
  if (!work_.valid()) return std::nullopt;
  LoopResult result = work_.get();
  result.corrections = for_all(std::move(result.corrections));
  return result;
}

}  // namespace hqslam::slam
