#pragma once

#include <array>
#include <cstdint>

#include "hqslam/core/pose.h"
#include "hqslam/sim/drive.h"
#include "style.h"

namespace hqslam::sim {

/// How a car sways on its springs with the sensor on its roof, by the distance s driven, so that a
/// standing car stands still and the pose is as smooth in time as the path:
///   roll, pitch, heave = sum_k a_k sin(w_k s + p_k),  2 pi / w_k about 47, 23, 13 and 8 m
class VehicleSway {
 public:
  VehicleSway(std::uint64_t seed, const SensorMount& mount);
  Pose T_vehicle_sensor(double along_m) const;

 private:
  struct Wave {
    double wave_number_rad_per_m;
    double phase_rad;
    double amplitude;
  };
  SensorMount mount_;
  std::array<std::array<Wave, 4>, 3> waves_;  ///< roll, pitch, heave
};

/// How a sensor moves in the hand of somebody who walks upright: it rolls, pitches and turns as the
/// style says, and rises with every step.
///   angle(t) = A (0.85 + 0.15 sin(w_slow t + p_slow)) sin(w t + p),  2 pi / w = 0.95 to 1.05 s
class HandSway {
 public:
  HandSway(std::uint64_t seed, const HandStyle& style, const SensorMount& mount);
  /// T_world_walker: the feet of who carries it, upright, x forward.
  Pose T_world_sensor(const Pose& T_world_walker, double time_s) const;

 private:
  struct Swing {
    double amplitude;
    double frequency_rad_per_s;
    double phase_rad;
    double slow_phase_rad;
    double at(double time_s) const;
  };
  Pose T_walker_hand_;
  Pose T_hand_mount_;
  std::array<Swing, 5> swings_;  ///< roll, pitch, yaw, aside, up
};

}  // namespace hqslam::sim
