#pragma once

#include <array>
#include <cstdint>

#include "hqslam/core/pose.h"

namespace hqslam::sim {

/// How a sensor moves in the hand of somebody who walks upright: it rolls and pitches by up to
/// `largest_rad` about once in a second, turns a little, and rises with every step.
///   angle(t) = A (0.85 + 0.15 sin(w_slow t + p_slow)) sin(w t + p),  2 pi / w = 0.95 to 1.05 s
class HandSway {
 public:
  HandSway(std::uint64_t seed, double largest_rad);
  /// Relative to where a hand that keeps still would hold it.
  Pose T_hand_sensor(double time_s) const;

 private:
  struct Swing {
    double amplitude;
    double frequency_rad_per_s;
    double phase_rad;
    double slow_phase_rad;
    double at(double time_s) const;
  };
  std::array<Swing, 5> swings_;  ///< roll, pitch, yaw, aside, up
};

}  // namespace hqslam::sim
