#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hqslam/core/trajectory.h"

namespace hqslam::slam {

/// The path driven so far: where each scan was, which key frame it moves with, and in which part of
/// the path it is. A stretch begins where nothing measured the way; stretches that loop closing
/// joined are one part.
class DrivenPath {
 public:
  /// A scan, when the map had so many key frames.
  void add(const StampedPose& pose, std::uint32_t key_frames);

  /// From here on, and for the scans before that were not located, the path has nothing to do with
  /// what was before: they move with the key frame that comes next.
  void begin_stretch(std::size_t unlocated_scans, std::uint32_t next_key_frame);

  /// What loop closing knows about the stretches: the part that each is of.
  void join(const std::vector<std::size_t>& part_of_stretch) { part_of_stretch_ = part_of_stretch; }

  /// Moves every scan with its key frame: in, per key frame, T_corrected_map.
  void correct(const std::vector<Pose>& corrections);

  const Trajectory& trajectory() const { return trajectory_; }
  const std::vector<std::size_t>& stretch_of_scan() const { return stretch_of_scan_; }
  std::vector<std::size_t> part_of_scan() const;

 private:
  Trajectory trajectory_;
  std::vector<std::uint32_t> key_frame_of_scan_;  ///< the last up to each
  std::vector<std::size_t> stretch_of_scan_;
  std::size_t last_stretch_ = 0;
  std::vector<std::size_t> part_of_stretch_;
};

}  // namespace hqslam::slam
