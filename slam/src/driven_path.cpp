#include "driven_path.h"

#include <algorithm>

namespace hqslam::slam {

void DrivenPath::add(const StampedPose& pose, std::uint32_t key_frames) {
  trajectory_.push_back(pose);
  key_frame_of_scan_.push_back(key_frames > 0 ? key_frames - 1 : 0);
  stretch_of_scan_.push_back(last_stretch_);
}

void DrivenPath::begin_stretch(std::size_t unlocated_scans, std::uint32_t next_key_frame) {
  ++last_stretch_;
  const auto from_there = [&](auto& of_scan) {
    return of_scan.end() - static_cast<std::ptrdiff_t>(std::min(unlocated_scans, of_scan.size()));
  };
  std::fill(from_there(key_frame_of_scan_), key_frame_of_scan_.end(), next_key_frame);
  std::fill(from_there(stretch_of_scan_), stretch_of_scan_.end(), last_stretch_);
}

void DrivenPath::correct(const std::vector<Pose>& corrections) {
  for (std::size_t scan = 0; scan < trajectory_.size(); ++scan) {
    const Pose& correction = corrections[key_frame_of_scan_[scan]];
    if (correction.matrix().isIdentity(0.0)) continue;
    Pose& T_map_sensor = trajectory_[scan].T_map_sensor;
    T_map_sensor = orthonormalized(correction * T_map_sensor);
  }
}

std::vector<std::size_t> DrivenPath::part_of_scan() const {
  std::vector<std::size_t> result;
  for (const std::size_t stretch : stretch_of_scan_) {
    result.push_back(stretch < part_of_stretch_.size() ? part_of_stretch_[stretch] : stretch);
  }
  return result;
}

}  // namespace hqslam::slam
