#include "segmented_trajectory.h"

#include <algorithm>

namespace hqslam::slam {

void SegmentedTrajectory::add(const StampedPose& pose, std::uint32_t keyframes) {
  trajectory_.push_back(pose);
  keyframe_of_scan_.push_back(keyframes > 0 ? keyframes - 1 : 0);
  segment_of_scan_.push_back(last_segment_);
}

void SegmentedTrajectory::begin_segment(std::size_t unlocated_scans, std::uint32_t next_keyframe) {
  ++last_segment_;
  const auto from_there = [&](auto& of_scan) {
    return of_scan.end() - static_cast<std::ptrdiff_t>(std::min(unlocated_scans, of_scan.size()));
  };
  std::fill(from_there(keyframe_of_scan_), keyframe_of_scan_.end(), next_keyframe);
  std::fill(from_there(segment_of_scan_), segment_of_scan_.end(), last_segment_);
}

void SegmentedTrajectory::correct(const std::vector<Pose>& corrections) {
  for (std::size_t scan = 0; scan < trajectory_.size(); ++scan) {
    const Pose& correction = corrections[keyframe_of_scan_[scan]];
    if (correction.matrix().isIdentity(0.0)) continue;
    Pose& T_map_sensor = trajectory_[scan].T_map_sensor;
    T_map_sensor = orthonormalized(correction * T_map_sensor);
  }
}

std::vector<std::size_t> SegmentedTrajectory::submap_of_scan() const {
  std::vector<std::size_t> result;
  for (const std::size_t segment : segment_of_scan_) {
    result.push_back(segment < submap_of_segment_.size() ? submap_of_segment_[segment] : segment);
  }
  return result;
}

}  // namespace hqslam::slam
