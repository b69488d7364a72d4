#include "segmented_trajectory.h"

#include <algorithm>

#include "alignment/drift.h"

namespace hqslam::slam {

void SegmentedTrajectory::add(const StampedPose& pose, std::uint32_t keyframes,
                              const Matrix6& own_covariance) {
  if (last_segment_ > 0) covariances_.push_back({trajectory_.size(), own_covariance, {}});
  trajectory_.push_back(pose);
  keyframe_of_scan_.push_back(std::max(keyframes, 1U) - 1);
  segment_of_scan_.push_back(last_segment_);
}

void SegmentedTrajectory::begin_segment(std::size_t missed_scans, std::uint32_t next_keyframe,
                                        bool is_carried) {
  ++last_segment_;
  const std::size_t first = trajectory_.size() - std::min(missed_scans, trajectory_.size());
  const auto from_first = [&](auto& of_scan) {
    return of_scan.begin() + static_cast<std::ptrdiff_t>(first);
  };
  std::fill(from_first(keyframe_of_scan_), keyframe_of_scan_.end(), next_keyframe);
  std::fill(from_first(segment_of_scan_), segment_of_scan_.end(), last_segment_);
  std::erase_if(covariances_, [&](const OwnCovariance& of) { return of.scan >= first; });
  if (!is_carried) return;
  for (std::size_t scan = first; scan < trajectory_.size(); ++scan) {
    covariances_.push_back({scan, unknown_covariance(), unknown_covariance()});
  }
}

void SegmentedTrajectory::improve(std::size_t segment, const Pose& T_map_near,
                                  const Matrix6& unmeasured) {
  for (OwnCovariance& of : covariances_) {
    if (segment_of_scan_[of.scan] != segment) continue;
    const Pose motion = T_map_near.inverse() * trajectory_[of.scan].T_map_sensor;
    of.corrected = of.own + carried(unmeasured, motion);
  }
}

std::vector<std::pair<std::size_t, Covariance>> SegmentedTrajectory::corrected_covariances() const {
  std::vector<std::pair<std::size_t, Covariance>> result;
  for (const OwnCovariance& of : covariances_) {
    if (of.corrected) result.emplace_back(of.scan, *of.corrected);
  }
  return result;
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
