#pragma once

#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "loops/loop_closing.h"

namespace hqslam::slam {

/// Loop closing beside the calls that bring scans: in a thread of its own, with nothing that the
/// calls touch, so that no scan waits for a search or for the optimisation of a long path.
///
/// What is begun with a keyframe is collected a fixed number of scans later, done or not (then the
/// call waits), so that the same scans give the same bytes however fast the machine is. Keyframes
/// of the meantime are kept for the next time, and moved along with what was found out.
class BackgroundLoopClosing {
 public:
  BackgroundLoopClosing(const MappingOptions& options, bool searches);

  /// Call with every scan, before it is looked for: what was found out, if this scan is the one
  /// that it was waited for. Corrections are given for all keyframes up to now.
  std::optional<LoopResult> collect();
  /// When no more scans are to come: the next of what is still to be found out; nothing: no more.
  std::optional<LoopResult> finish();

  /// Whether the next keyframe, which is there, is to have a view.
  bool wants_view(const Pose& T_map_sensor) const;
  void add(LoopKeyframe keyframe);

  /// What is known when all that was begun is done; waits for that.
  const KeyframeGraph& finished() const;
  /// All of the map, by submap: what left the sliding window, and the window itself, as it will be
  /// when all that was begun is applied. Waits for that.
  std::vector<FeatureMaps> whole_map(const FeatureMaps& matched_with) const;

 private:
  void begin();
  LoopResult awaited() const;
  LoopResult collected();

  MappingOptions options_;
  std::unique_ptr<LoopClosing> loop_closing_;  ///< belongs to the thread while there is one
  std::shared_future<LoopResult> work_;
  int scans_until_due_ = 0;
  std::vector<LoopKeyframe> waiting_;  ///< keyframes for the next time
  std::size_t keyframes_begun_ = 0;    ///< those before
  bool view_waits_ = false;
  double since_view_m_ = 0.0;
  std::optional<Pose> T_map_last_;  ///< the last keyframe
};

}  // namespace hqslam::slam
