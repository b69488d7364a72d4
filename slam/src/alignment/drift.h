#pragma once

#include <optional>

#include "alignment/motion_state.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::slam {

/// How far a path of dead reckoning may have come away from the truth.
///
/// A scan is registered in the map that the scans before it made: its error against that map is
/// small and soon forgotten, but a share of it stays in the map and so in all poses that follow:
///
///   D <- Ad(T^-1) D Ad(T^-1)^T + step share A + start (exp(-path / L) - exp(-(path + step) / L)),
///
/// with the motion T since the scan before, the step in metres, the path up to it, and the
/// covariance A of a scan's pose against the map,
///
///   A = K P K + diag(shake).
///
/// P is that of the estimate. It takes the errors of features as independent, but neighbours err
/// together, and the more so the fewer things there are to see. So K multiplies standard
/// deviations, one factor along each axis of the sensor, for the information about them differs.
/// Where the sensor is and which way it looks, as seen from above (x, y, yaw), the factor grows
/// with the variances of x and y in P:
///
///   K_x^2 = K_y^2 = along u^q,  K_yaw^2 = heading u^q,  u = (P_xx + P_yy) / (2 (5 mm)^2) <= 100.
///
/// `shake` is what a sensor does that is not moved evenly, in a hand, say: a scan is corrected for
/// a motion that it did not quite make. It is a share of the mean square of the velocity's change
/// from scan to scan times the scan's period, along and about each axis.
///
/// `start` is a tilt: within the first metres, in a map of a few scans, what the ground does
/// between its rows is measured by chords, and the error stays for good; it grows with their
/// spacing.
///
/// The numbers are those that make the errors most likely on 68 runs over simulated drives (`town`,
/// `hills`, `meadow`, seeds 101 to 110, `indoors` and `handheld`, 101 and 102, which count half; 16
/// and 64 rows). A slip is no drift and in no covariance.
class Drift {
 public:
  explicit Drift(const SensorModel& sensor);

  /// How the sensor moves: the velocity of every scan that was registered, one after the other.
  void learn(const Twist& velocity);
  /// A scan was registered: `state` against the map, `motion` since the scan before.
  void grow(const Pose& motion, const MotionState& state);
  /// A scan was followed by the odometry alone.
  void move(const Pose& motion);
  /// The map goes on from a pose that nothing measured.
  void lose(const MotionState& expected);

  /// Of T_map_sensor against the truth, the first scan's pose being exact: (linear, angular) in the
  /// sensor's frame. motion: since the last scan that was followed.
  Matrix6 covariance(const Pose& motion, const MotionState& state) const;

 private:
  Matrix6 against_map(const MotionState& state) const;

  double start_variance_;
  double scan_period_s_;
  std::optional<Twist> velocity_;    ///< of the last scan that was registered
  Vector6 jolts_ = Vector6::Zero();  ///< mean squares of a scan's unforeseen motion, m^2, rad^2
  double path_m_ = 0.0;
  Matrix6 drift_ = Matrix6::Zero();
};

}  // namespace hqslam::slam
