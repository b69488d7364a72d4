#pragma once

#include <optional>

#include "alignment/motion_state.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::slam {

/// A covariance of e in T exp(e) at another pose that moves with T.
Matrix6 carried(const Matrix6& covariance, const Pose& motion);

struct DriftState {
  Matrix6 drift = Matrix6::Zero();       ///< come up along the path
  Matrix6 unmeasured = Matrix6::Zero();  ///< where the way was lost
  bool is_anywhere = false;              ///< nothing is known of the pose

  Matrix6 total() const { return drift + unmeasured; }
};
/// The same at another pose of the path, without what comes up on the way there.
DriftState carried(const DriftState& state, const Pose& motion);

/// What loop closing found out about the drift at a pose of the path.
struct DriftImprovement {
  DriftState before;
  DriftState after;
};
/// The state at a later pose, now that more is known of an earlier one. In: the motion between the
/// two; whether the way from one to the other was never lost.
DriftState improved(const DriftState& later, const DriftImprovement& earlier, const Pose& motion,
                    bool is_way_known);

/// How far a path of dead reckoning may have come away from the truth.
///
/// A scan is registered in the map that the scans before it made: its error against that map is
/// small and soon forgotten, but a share of it stays in the map and so in all poses that follow:
///
///   D <- Ad(T^-1) D Ad(T^-1)^T + step share A + step lean
///        + (start + shake) (exp(-path / L) - exp(-(path + step) / L)),
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
/// from scan to scan times the scan's period, along and about each axis. The first scans make the
/// map, so what they are off by stays for good.
///
/// `start` is a tilt: within the first metres, in a map of a few scans, what the ground does
/// between its rows is measured by chords, and the error stays for good; it grows with their
/// spacing.
///
/// `lean` is a tilt, too: beams that are off by hundredths of a degree (of a sensor as makers
/// promise it) make the map bend by a degree or so in a hundred metres. It is the largest part by
/// far. Where gravity levels the path a sixteenth of it is left, and what such beams do along the
/// ground.
///
/// Where the way was lost, what was expected of the motion (its covariance grows with the time that
/// nothing was seen) is added for good, as `unmeasured`; a sensor that was carried away is nowhere
/// known, its variances are infinite. Loop closing takes away what it measured anew.
///
/// The numbers are those that make the errors most likely on 68 runs over simulated drives (`town`,
/// `hills`, `meadow`, seeds 101 to 110, `indoors` and `handheld`, 101 and 102, which count half; 16
/// and 64 rows), of a perfect sensor; `lean` is of `town`, `hills`, `meadow` and `narrow`, seeds 71
/// to 75, of one that is off (`typical`), what gravity leaves of the same kinds, 7201 to 7205, 16
/// rows. A slip is no drift and in no covariance.
class Drift {
 public:
  explicit Drift(const SensorModel& sensor);

  /// How the sensor moves: the velocity of every scan that was registered, one after the other.
  void learn(const Twist& velocity);
  /// A scan was registered: `state` against the map, `motion` since the scan before.
  /// is_levelled: gravity takes away most of what beams that are off make it lean.
  void grow(const Pose& motion, const MotionState& state, bool is_levelled = false);
  /// A scan was followed by the odometry alone.
  void move(const Pose& motion);
  /// The map goes on from a pose that nothing measured; in: its covariance against the map before.
  /// is_carried: the sensor is elsewhere than anybody could expect.
  void lose(const Matrix6& against_map, bool is_carried);
  void set(const DriftState& state) { state_ = state; }

  const DriftState& state() const { return state_; }

  /// A, of a scan that was registered.
  Matrix6 against_map(const MotionState& state) const;
  /// Of T_map_sensor against the truth, the first scan's pose being exact: (linear, angular) in the
  /// sensor's frame. motion: since the last scan that was followed.
  Matrix6 covariance(const Pose& motion, const Matrix6& against_map) const;
  /// The same without what was not measured where the way was lost.
  Matrix6 own_covariance(const Pose& motion, const Matrix6& against_map) const;

 private:
  /// Variances of a scan's pose, by uneven motion.
  Vector6 shake() const;

  double start_variance_;
  double scan_period_s_;
  std::optional<Twist> velocity_;    ///< of the last scan that was registered
  Vector6 jolts_ = Vector6::Zero();  ///< mean squares of a scan's unforeseen motion, m^2, rad^2
  int jolts_seen_ = 0;
  double path_m_ = 0.0;
  DriftState state_;
};

}  // namespace hqslam::slam
