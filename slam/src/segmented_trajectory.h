#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "alignment/motion_state.h"
#include "hqslam/core/trajectory.h"

namespace hqslam::slam {

/// The trajectory so far: where each scan was, which keyframe it moves with, and which segment it
/// is on. A segment begins where nothing measured the way; those that loop closing joined are in
/// one submap.
class SegmentedTrajectory {
 public:
  /// A scan, when the map had so many keyframes. own_covariance: of the pose, without what was not
  /// measured before its segment.
  void add(const StampedPose& pose, std::uint32_t keyframes, const Matrix6& own_covariance);

  /// From here on, and for the scans before that were not registered, the path has nothing to do
  /// with what was before: they move with the keyframe that comes next.
  /// is_carried: nothing at all is known of those scans.
  void begin_segment(std::size_t missed_scans, std::uint32_t next_keyframe, bool is_carried);

  /// What loop closing knows about the segments: the submap that each is in.
  void join(const std::vector<std::size_t>& submap_of_segment) {
    submap_of_segment_ = submap_of_segment;
  }

  /// Loop closing found out how a segment lies: in, at a pose T_map_near in its frame, the
  /// covariance of what was not measured before it. Before correct().
  void improve(std::size_t segment, const Pose& T_map_near, const Matrix6& unmeasured);
  /// Of scans for which another covariance holds than was reported.
  std::vector<std::pair<std::size_t, Matrix6>> corrected_covariances() const;

  /// Moves every scan with its keyframe: in, per keyframe, T_corrected_map.
  void correct(const std::vector<Pose>& corrections);

  std::size_t last_segment() const { return last_segment_; }
  const Trajectory& trajectory() const { return trajectory_; }
  const std::vector<std::size_t>& segment_of_scan() const { return segment_of_scan_; }
  std::vector<std::size_t> submap_of_scan() const;

 private:
  Trajectory trajectory_;
  std::vector<std::uint32_t> keyframe_of_scan_;  ///< the last up to each
  std::vector<std::size_t> segment_of_scan_;
  std::size_t last_segment_ = 0;
  /// Of scans on all segments but the first.
  struct OwnCovariance {
    std::size_t scan = 0;
    Matrix6 own;
    std::optional<Matrix6> corrected;
  };
  std::vector<OwnCovariance> covariances_;
  std::vector<std::size_t> submap_of_segment_;
};

}  // namespace hqslam::slam
