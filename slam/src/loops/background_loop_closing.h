#pragma once

#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "loops/loop_closing.h"

namespace hqslam::slam {

/// Loop closing in a thread of its own, which shares no data with the calls that bring scans, so
/// that no scan waits for a search or for the optimisation of a long path.
///
/// Work begun with a keyframe is collected a fixed number of scans later, finished or not (then the
/// call waits), so that the same scans give the same bytes on any machine. Keyframes of the
/// meantime wait for the next work, and move with the corrections.
class BackgroundLoopClosing {
 public:
  BackgroundLoopClosing(const MappingOptions& options, bool searches);

  /// To be called with every scan, before its registration: the result, if it is due with this
  /// scan. Corrections are for all keyframes up to now.
  std::optional<LoopResult> collect();
  /// After the last scan: the next result of the remaining work; nothing if there is none.
  std::optional<LoopResult> finish();

  /// Whether a keyframe at this pose is to have a view.
  bool wants_view(const Pose& T_map_sensor) const;
  void add(LoopKeyframe keyframe);

  /// The graph after the present work; waits for that.
  const KeyframeGraph& finished() const;
  /// The whole map, by submap: the points that left the sliding window and the window itself, with
  /// the result of the present work applied. Waits for that.
  std::vector<FeatureMaps> whole_map(const FeatureMaps& matched_with) const;

 private:
  void begin();
  LoopResult awaited() const;
  LoopResult collected();

  MappingOptions options_;
  std::unique_ptr<LoopClosing> loop_closing_;  ///< belongs to the thread while there is one
  std::shared_future<LoopResult> work_;
  int scans_until_due_ = 0;
  std::vector<LoopKeyframe> waiting_;  ///< keyframes for the next work
  std::size_t keyframes_begun_ = 0;    ///< number of keyframes before those
  bool view_waits_ = false;
  double since_view_m_ = 0.0;
  std::optional<Pose> T_map_last_;  ///< the last keyframe
};

}  // namespace hqslam::slam
