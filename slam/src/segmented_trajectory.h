#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "alignment/motion_state.h"
#include "hqslam/slam/slam.h"

namespace hqslam::slam {

/// The trajectory so far: the pose of each scan, the keyframe with which it moves, and its segment.
/// A segment begins where the motion is unknown; those that loop closing joined are in one submap.
class SegmentedTrajectory {
 public:
  /// keyframes: number of keyframes after this scan. own_covariance: Drift::own_covariance.
  void add(const StampedPose& pose, std::uint32_t keyframes, const Matrix6& own_covariance);

  /// Begins a segment with the last missed_scans, which move with the next keyframe. is_carried:
  /// their poses are unknown.
  void begin_segment(std::size_t missed_scans, std::uint32_t next_keyframe, bool is_carried);

  /// In: the submap of each segment, by loop closing.
  void join(const std::vector<std::size_t>& submap_of_segment) {
    submap_of_segment_ = submap_of_segment;
  }

  /// Loop closing measured the pose of a segment. In: DriftState::unmeasured at a pose T_map_near
  /// in its frame. To be called before correct().
  void improve(std::size_t segment, const Pose& T_map_near, const Matrix6& unmeasured);
  /// The covariances that differ from the reported ones, by scan.
  std::vector<std::pair<std::size_t, Covariance>> corrected_covariances() const;

  /// Moves every scan with its keyframe; in: T_corrected_map of each keyframe.
  void correct(const std::vector<Pose>& corrections);

  std::size_t last_segment() const { return last_segment_; }
  const Trajectory& trajectory() const { return trajectory_; }
  const std::vector<std::size_t>& segment_of_scan() const { return segment_of_scan_; }
  std::vector<std::size_t> submap_of_scan() const;

 private:
  Trajectory trajectory_;
  std::vector<std::uint32_t> keyframe_of_scan_;  ///< the last one up to the scan
  std::vector<std::size_t> segment_of_scan_;
  std::size_t last_segment_ = 0;
  /// Of a scan on another segment than the first.
  struct OwnCovariance {
    std::size_t scan = 0;
    Matrix6 own;
    std::optional<Matrix6> corrected;
  };
  std::vector<OwnCovariance> covariances_;
  std::vector<std::size_t> submap_of_segment_;
};

}  // namespace hqslam::slam
