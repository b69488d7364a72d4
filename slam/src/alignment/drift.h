#pragma once

#include <optional>

#include "alignment/motion_state.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::slam {

/// Infinite variances: the pose is unknown.
Matrix6 unknown_covariance();

/// A covariance of e in T exp(e), for another pose rigidly connected with T.
Matrix6 carried(const Matrix6& covariance, const Pose& motion);
/// What a motion adds to the covariance of the pose before it, at most: of expected - carried(
/// before, motion) the positive part (its eigenvectors with eigenvalues above 0, in metres and
/// radians). The difference alone is no covariance where the velocity's errors undo the pose's.
Matrix6 growth(const Matrix6& before, const Matrix6& expected, const Pose& motion);

struct DriftState {
  Matrix6 drift = Matrix6::Zero();       ///< accumulated along the path
  Matrix6 unmeasured = Matrix6::Zero();  ///< of the motion while tracking was lost
  bool is_anywhere = false;              ///< the pose is unknown

  Matrix6 total() const { return drift + unmeasured; }
};
/// The state at another pose of the path, without the drift between the two.
DriftState carried(const DriftState& state, const Pose& motion);

/// The drift at a pose of the path before and after loop closing.
struct DriftImprovement {
  DriftState before;
  DriftState after;
};
/// The state at a later pose after that of an earlier one improved. In: the motion between the two;
/// whether tracking was never lost between them.
DriftState improved(const DriftState& later, const DriftImprovement& earlier, const Pose& motion,
                    bool is_path_known);

/// The covariance of dead reckoning along the path.
///
/// A scan is registered in the map of the scans before it. Its error against that map is small and
/// does not last, but a share of it stays in the map and so in all later poses:
///
///   D <- Ad(T^-1) D Ad(T^-1)^T + step share A + step lean
///        + (start + shake + turn) (exp(-path / L) - exp(-(path + step') / L)),
///
/// with the motion T since the scan before, the step in metres, step' = step + L times its turn in
/// radians, the sum of those as path, and the covariance A of a scan's pose against the map,
///
///   A = K P K + diag(shake).
///
/// P is that of the estimate, which takes the errors of features as independent. Those of
/// neighbours are correlated, the more so the fewer objects there are. So K multiplies the standard
/// deviations, with a factor for each axis of the sensor, since the information about them differs.
/// For x, y and yaw it grows with the variances of x and y in P:
///
///   K_x^2 = K_y^2 = along u^q,  K_yaw^2 = heading u^q,  u = (P_xx + P_yy) / (2 (5 mm)^2) <= 100.
///
/// `shake` comes from uneven motion, of a hand for instance: the motion for which a scan is
/// corrected is not quite its own. It is a share of the mean square of the velocity's change from
/// scan to scan times the scan's period, along and about each axis; before there is a second
/// velocity half of the turn counts as such a change. Errors of the first scans, which make the
/// map, remain. `turn` is what uneven turns add to these: the first scan is corrected with the
/// velocity of the second.
///
/// `start` is a tilt: within the first metres, in a map of a few scans, the ground between the rows
/// is interpolated by chords, and the resulting error remains; it grows with the spacing of the
/// rows.
///
/// `lean` is a tilt, too: beam errors of hundredths of a degree (within makers' specifications)
/// bend the map by about a degree in a hundred metres. This is by far the largest term. Where
/// gravity levels the path a sixteenth of it is left, plus the effect of such beams along the
/// ground.
///
/// Where no ground is in view (a covered lower half of the sensor, a deck below it) and gravity is
/// not known either, nothing but rings on walls, whose errors are systematic, holds the tilt: it
/// then grows eight hundred times as fast.
///
/// After tracking was lost, the covariance of the expected motion (which grows with the time
/// without registration) is added permanently, as `unmeasured`; the pose of a sensor that was
/// carried away is unknown, with infinite variances. A keyframe that was inserted at a hardly known
/// pose takes the map along: by how much a later scan's covariance against such a map is smaller
/// than the keyframe's is added to `unmeasured`, too. Loop closing removes what it measured anew.
///
/// The parameters maximise the likelihood of the errors on 68 runs over simulated drives (`town`,
/// `hills`, `meadow`, seeds 101 to 110, `indoors` and `handheld`, 101 and 102, with half weight; 16
/// and 64 rows) of a perfect sensor; `lean` is from `town`, `hills`, `meadow` and `narrow`, seeds
/// 71 to 75, with beam errors (`typical`), and its rest after levelling from the same kinds, 7201
/// to 7205, 16 rows. A slip is no drift and in no covariance.
class Drift {
 public:
  /// What holds the tilt of a registered scan.
  enum class Level { kByGround, kByGravity, kByNothing };

  explicit Drift(const SensorModel& sensor);

  /// In: the velocity of every registered scan, in order.
  void learn(const Twist& velocity);
  /// A scan was registered: `state` against the map, `motion` since the scan before.
  void grow(const Pose& motion, const MotionState& state, Level level = Level::kByGround);
  /// A scan was followed by the odometry alone.
  void move(const Pose& motion);
  /// The map goes on from an unmeasured pose. In: the covariance of that against the map before;
  /// whether the sensor was carried, so that its pose is unknown.
  void lose(const Matrix6& against_map, bool is_carried);
  /// A keyframe was inserted at a pose of this covariance against the map, which is hardly known.
  void add_uncertain_keyframe(const Matrix6& against_map) { uncertain_keyframe_ = against_map; }
  /// A scan was registered with this covariance. If there is such a keyframe in its map, the
  /// difference between the two becomes `unmeasured`. is_known: the scan's pose is well known, and
  /// the keyframe is no longer compared. Returns whether there was one.
  bool inherit_uncertainty(const Matrix6& against_map, bool is_known);
  void set(const DriftState& state) { state_ = state; }

  const DriftState& state() const { return state_; }
  /// Whether the sensor turns so unevenly, as in a hand or on a robot in rooms, or just did, that a
  /// scan is better corrected by the velocity that it measures itself.
  bool is_uneven() const;

  /// The matrix A of a registered scan.
  Matrix6 against_map(const MotionState& state) const;
  /// The covariance of T_map_sensor against the truth, the first scan's pose being exact: (linear,
  /// angular) in the sensor's frame. motion: since the last scan that was followed.
  Matrix6 covariance(const Pose& motion, const Matrix6& against_map) const;
  /// The covariance without DriftState::unmeasured.
  Matrix6 own_covariance(const Pose& motion, const Matrix6& against_map) const;

 private:
  /// Mean squares of the unforeseen motion within a scan of this velocity, m^2, rad^2.
  Vector6 jolts(const Twist& velocity) const;
  /// Variances of a scan's pose due to uneven motion.
  Vector6 shake(const Twist& velocity) const;

  double start_variance_;
  double scan_period_s_;
  std::optional<Twist> velocity_;        ///< of the last scan that was registered
  Vector6 jolts_ = Vector6::Zero();      ///< mean squares of a scan's unforeseen motion, m^2, rad^2
  Vector6 last_jolt_ = Vector6::Zero();  ///< squares of that within the last scan
  int jolt_count_ = 0;
  double start_path_m_ = 0.0;   ///< with turns, as a length
  double unheld_path_m_ = 0.0;  ///< since the last scan of another level than kByNothing
  DriftState state_;
  std::optional<Matrix6> uncertain_keyframe_;  ///< at the sensor's present pose
};

}  // namespace hqslam::slam
