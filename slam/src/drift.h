#pragma once

#include "hqslam/slam/motion_state.h"

namespace hqslam::slam {

/// How far a path of dead reckoning may have come away from the truth.
///
/// A scan is located in the map that the scans before it made: its error against that map is small
/// and soon forgotten, but a share of it stays in the map and so in all poses that follow:
///
///   D <- Ad(T^-1) D Ad(T^-1)^T + step share P,
///
/// with the motion T since the scan before, the covariance P of a scan's pose against the map, the
/// step in metres and the share per metre. P takes the errors of features as independent. They are
/// not: neighbours err together. So P is multiplied by a factor. Share and factor are rough
/// guesses, not calibrated: on two simulated drives the squared error over the covariance was 22
/// and 26 on average where 6 would be right, most of it a tilt of 0.2 degrees from the first scans.
class Drift {
 public:
  /// A scan was located: `state` against the map, `motion` since the scan before.
  void locate(const Pose& motion, const MotionState& state);
  /// The map goes on from a pose that nothing measured.
  void lose(const MotionState& expected);

  /// Of T_map_sensor against the truth, the first scan's pose being exact: (linear, angular) in the
  /// sensor's frame.
  Matrix6 covariance(const MotionState& state) const;

 private:
  Matrix6 drift_ = Matrix6::Zero();
};

}  // namespace hqslam::slam
