#pragma once

#include "hqslam/core/sensor_model.h"
#include "hqslam/slam/motion_state.h"

namespace hqslam::slam {

/// How far a path of dead reckoning may have come away from the truth.
///
/// A scan is located in the map that the scans before it made: its error against that map is small
/// and soon forgotten, but a share of it stays in the map and so in all poses that follow:
///
///   D <- Ad(T^-1) D Ad(T^-1)^T + step share A + start (exp(-path / L) - exp(-(path + step) / L)),
///
/// with the motion T since the scan before, the step in metres, the path up to it, and the
/// covariance A of a scan's pose against the map. That of the estimate, P, takes the errors of
/// features as independent. They are not: neighbours err together, the more so the farther apart
/// the rows that planes are laid through. So A = K P K, where K multiplies standard deviations, one
/// factor along each axis of the sensor, for what tells them differs, and all of them grow with the
/// spacing of the measured rows. `start` is a tilt: within the first metres, in a map of a few
/// scans, what the ground does between its rows is told by chords, and the error stays for good.
///
/// The numbers are those that make the errors most likely on 17 runs over simulated drives (`town`,
/// `hills`, `meadow`, 16 and 64 rows, seeds from 101 on). In open land at 16 rows a start can still
/// tilt by more than they allow for; a slip is no drift and in no covariance.
class Drift {
 public:
  explicit Drift(const SensorModel& sensor);

  /// A scan was located: `state` against the map, `motion` since the scan before.
  void locate(const Pose& motion, const MotionState& state);
  /// A scan was followed by the odometry alone.
  void move(const Pose& motion);
  /// The map goes on from a pose that nothing measured.
  void lose(const MotionState& expected);

  /// Of T_map_sensor against the truth, the first scan's pose being exact: (linear, angular) in the
  /// sensor's frame. motion: since the last scan that was followed.
  Matrix6 covariance(const Pose& motion, const MotionState& state) const;

 private:
  Matrix6 against_map(const MotionState& state) const;

  Vector6 factor_;
  double start_variance_;
  double path_m_ = 0.0;
  Matrix6 drift_ = Matrix6::Zero();
};

}  // namespace hqslam::slam
