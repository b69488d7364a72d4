#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hqslam/core/trajectory.h"

namespace hqslam::slam {

/// The trajectory so far: where each scan was, which keyframe it moves with, and which segment it
/// is on. A segment begins where nothing measured the way; those that loop closing joined are in
/// one submap.
class SegmentedTrajectory {
 public:
  /// A scan, when the map had so many keyframes.
  void add(const StampedPose& pose, std::uint32_t keyframes);

  /// From here on, and for the scans before that were not registered, the path has nothing to do
  /// with what was before: they move with the keyframe that comes next.
  void begin_segment(std::size_t unlocated_scans, std::uint32_t next_keyframe);

  /// What loop closing knows about the segments: the submap that each is in.
  void join(const std::vector<std::size_t>& submap_of_segment) {
    submap_of_segment_ = submap_of_segment;
  }

  /// Moves every scan with its keyframe: in, per keyframe, T_corrected_map.
  void correct(const std::vector<Pose>& corrections);

  const Trajectory& trajectory() const { return trajectory_; }
  const std::vector<std::size_t>& segment_of_scan() const { return segment_of_scan_; }
  std::vector<std::size_t> submap_of_scan() const;

 private:
  Trajectory trajectory_;
  std::vector<std::uint32_t> keyframe_of_scan_;  ///< the last up to each
  std::vector<std::size_t> segment_of_scan_;
  std::size_t last_segment_ = 0;
  std::vector<std::size_t> submap_of_segment_;
};

}  // namespace hqslam::slam
