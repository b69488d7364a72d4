// Registration of a scan from its reference: prediction, odometry where it is needed, mapping,
// judgement.

#include <algorithm>
#include <cmath>

#include "map/choice_of_start.h"
#include "map/registration_trace.h"
#include "slam_implementation.h"

namespace hqslam::slam {

namespace {

/// Without measurements a velocity is assumed constant for this time: checked on real
/// drives without returns for a second (HDL-64E, VLP-16).
constexpr double kSteady_periods = 10.0;
/// Smallest share of the last registered scan's ratios. From scan to scan the inlier ratio falls to
/// 0.83 at the lowest on simulated drives of all kinds, and to 0.44 in another street.
constexpr double kLeastShareOfInlierRatio = 0.6;

Matrix6 pose_covariance(const MotionState& state) { return state.covariance.topLeftCorner<6, 6>(); }

/// Whether a sensor that is not carried can deviate this much from its expected state.
bool is_plausible(const MotionState& expected, const Twist& innovation, double duration_s) {
  constexpr double kAccelerated_m_s2 = 10.0;
  constexpr double kTurned_rad_s2 = 5.0;
  constexpr double kDeviations = 2.0;  // 95 %
  const double half_square_s2 = 0.5 * duration_s * duration_s;
  const Vector6 variance = expected.covariance.diagonal().head<6>();
  const double deviation_m = std::sqrt(variance.head<3>().sum());
  const double deviation_rad = std::sqrt(variance.tail<3>().sum());
  return innovation.linear.norm() <=
             std::max(0.5 + kAccelerated_m_s2 * half_square_s2, kDeviations * deviation_m) &&
         innovation.angular.norm() <=
             std::max(0.2 + kTurned_rad_s2 * half_square_s2, kDeviations * deviation_rad);
}

/// Leaves the pose as uncertain as its prediction.
void doubt(const MotionState& expected, MappingResult& matched) {
  matched.state.covariance = expected.covariance;
  matched.known.setZero();
  if (matched.status == Status::kOk) matched.status = Status::kDegenerate;
}

/// Whether an uncertain pose was found where the scan fits less than usual, or no better than
/// elsewhere.
bool may_be_elsewhere(const Tracking& last, const MotionState& expected,
                      const MappingResult& matched, double least_share) {
  return !is_precise(expected) &&
         (matched.is_ambiguous || matched.close_ratio < least_share * last.usual_close_ratio);
}

/// The covariance of the pose in the map, for a scan that was not registered.
Matrix6 grown(const Reference& reference, const MotionState& expected, const Pose& motion) {
  return carried(reference.against_map, motion) +
         growth(pose_covariance(reference.state), pose_covariance(expected), motion);
}

}  // namespace

/// The odometry's motion since the reference, which takes time: computed where it is first needed.
class OdometryOnDemand {
 public:
  OdometryOnDemand(const Reference& reference, const Scan& scan, const Pose& T_map_expected,
                   Notes& notes)
      : reference_(reference),
        scan_(scan),
        predicted_{reference.state.T_map_sensor.inverse() * T_map_expected,
                   scan.time_s - reference.time_s},
        notes_(notes) {}

  const OdometryResult& result() {
    if (result_) return *result_;
    ScanReport& report = notes_.report;
    report.times.mapping_s += notes_.stopwatch.lap_s();
    result_ = scan_to_scan(reference_.target, scan_.features, predicted_);
    report.odometry_status = result_->status;
    report.times.odometry_s += notes_.stopwatch.lap_s();
    return *result_;
  }
  /// The reference's pose, moved by the odometry.
  Pose T_map_sensor() {
    return orthonormalized(reference_.state.T_map_sensor * result().T_reference_sensor);
  }

 private:
  const Reference& reference_;
  const Scan& scan_;
  PredictedMotion predicted_;
  Notes& notes_;
  std::optional<OdometryResult> result_;
};

/// The prediction by inertial data; nothing unless they cover the time since the reference.
std::optional<InertialPrediction> Slam::Implementation::predicted_by_imu(const Reference& reference,
                                                                         const Scan& scan) const {
  const bool is_clock_steady =
      std::abs((scan.stamp_s - reference.stamp_s) - (scan.time_s - reference.time_s)) < 1e-6;
  if (!reference.inertial || !scan.turning || !is_clock_steady) return std::nullopt;
  const std::vector<ImuStep> steps =
      imu.steps(reference.stamp_s, scan.stamp_s, mounting.turn_to_level());
  if (steps.empty()) return std::nullopt;
  return predicted(reference.state, *reference.inertial, steps,
                   scan.turning->mean_rate_rad_per_s());
}

/// Whether the result of mapping is accepted, and otherwise the odometry's.
Registered Slam::Implementation::judged(const Tracking& last, const Scan& scan,
                                        const MotionState& expected, const MappingResult& matched,
                                        OdometryOnDemand& odometry) const {
  // inlier_ratio alone is that of a wide search, which may have begun far from the result. A place
  // that no vehicle can have reached is wrong unless the scan fits there as the last one did.
  const bool fits_elsewhere = matched.inlier_ratio < kLeastShareOfInlierRatio * last.inlier_ratio &&
                              matched.close_ratio < kLeastShareOfInlierRatio * last.close_ratio;
  const double duration_s = scan.time_s - last.reference.time_s;
  const auto is_possible = [&](const Pose& T_map_sensor) {
    return is_plausible(expected, logarithm(expected.T_map_sensor.inverse() * T_map_sensor),
                        duration_s);
  };
  const bool is_elsewhere =
      fits_elsewhere || (!is_possible(matched.state.T_map_sensor) &&
                         matched.close_ratio < kDoubtfulFit * last.close_ratio);
  Registered found;
  found.is_registered =
      matched.status != Status::kTooFewFeatures && !is_elsewhere &&
      (!place_recognition || (is_in_given_map(scan.map_features, matched.state) &&
                              !may_be_elsewhere(last, expected, matched, kLeastShareInGivenMap)));
  found.has_near_ground = matched.has_near_ground;
  found.inlier_ratio = matched.inlier_ratio;
  found.close_ratio = matched.close_ratio;
  found.state = matched.state;
  if (found.is_registered) return found;
  const OdometryResult& moved = odometry.result();
  const Pose T_map_moved = odometry.T_map_sensor();
  const bool is_moved = is_possible(T_map_moved);
  found.state = expected;
  if (is_moved) {
    found.state.T_map_sensor = T_map_moved;
    found.state.velocity = (1.0 / duration_s) * logarithm(moved.T_reference_sensor);
  }
  found.by_odometry = moved.status != Status::kTooFewFeatures;
  found.is_motion_plausible = found.by_odometry && !is_elsewhere && is_moved;
  found.is_contradiction = scan.has_enough_features && is_precise(expected) &&
                           (is_elsewhere || (found.by_odometry && !found.is_motion_plausible));
  if (found.is_contradiction && !is_moved) {
    // Either may be wrong: the sensor was moved between two scans, or the odometry went astray.
    const Twist rejected = logarithm(expected.T_map_sensor.inverse() * T_map_moved);
    found.state.covariance.topLeftCorner<6, 6>().diagonal() += vector_of(rejected).cwiseAbs2();
  }
  return found;
}

/// What the inertial sensor has learned from a registration; nothing without one.
std::optional<InertialState> Slam::Implementation::inertial_after(
    const Reference& reference, const std::optional<InertialPrediction>& measured,
    const MappingResult& matched, const Registered& found) const {
  if (!measured) {
    if (!reference.inertial || !inertial_check.agrees()) return std::nullopt;
    return kept(*reference.inertial, found.state);
  }
  // What a wrong sample did to the prediction is no error of biases or gravity.
  const bool is_usual = found.is_registered && found.innovation < InertialCheck::kMostOfScan;
  return is_usual ? corrected(*measured, found.state, matched.information, matched.known)
                  : kept(measured->inertial, found.state);
}

/// Puts the pose of a scan, its covariance and its status into the report.
void Slam::Implementation::put_report(const Reference& reference, const Scan& scan,
                                      const MappingResult& matched, const Registered& found,
                                      Notes& notes) const {
  ScanReport& report = notes.report;
  // ScanClock replaces a very long gap by one period.
  const double gap_s = std::max(scan.time_s - reference.time_s, scan.stamp_s - reference.stamp_s);
  report.mapping_status = !found.is_registered                             ? Status::kTooFewFeatures
                          : gap_s > kSteady_periods * sensor.scan_period_s ? Status::kAfterGap
                                                                           : matched.status;
  report.edge_correspondences = matched.edge_correspondences;
  report.planar_correspondences = matched.planar_correspondences;
  report.T_map_sensor = found.state.T_map_sensor;
  const Pose motion = reference.state.T_map_sensor.inverse() * found.state.T_map_sensor;
  report.covariance = drift.covariance(motion, found.against_map);
  report.T_odom_sensor = orthonormalized(reference.T_odom_sensor * motion);
  notes.own_covariance = drift.own_covariance(motion, found.against_map);
}

/// Registers a scan: prediction, odometry, mapping.
Registered Slam::Implementation::registered(const Tracking& last, const Scan& scan,
                                            Notes& notes) const {
  const Reference& reference = last.reference;
  const double duration_s = scan.time_s - reference.time_s;
  const std::optional<InertialPrediction> measured = predicted_by_imu(reference, scan);
  notes.report.predicted_by_imu = measured.has_value();
  // Not with an inertial sensor: it would mask that sensor's gain and delay its acceptance.
  const bool measures_velocity =
      drift.is_uneven() && !scan.cloud.time_offset_s.empty() && !reference.inertial;
  const MotionState expected =
      measured ? measured->state
               : predicted(reference.state, duration_s, kSteady_periods * sensor.scan_period_s,
                           accelerations.density(), measures_velocity);
  OdometryOnDemand odometry(reference, scan, expected.T_map_sensor, notes);
  const auto& first = last.first_keyframe;
  const Pose T_map_start = first && first->T_map_next ? *first->T_map_next : expected.T_map_sensor;
  MappingResult matched = register_from_starts(
      mapping, scan.map_features,
      {expected, T_map_start, [&] { return odometry.T_map_sensor(); }, reference.state.T_map_sensor,
       duration_s, is_precise(expected) ? last.close_ratio : last.usual_close_ratio,
       measured.has_value(), first && !first->T_map_next});
  if (may_be_elsewhere(last, expected, matched, kLeastShareOfUsualFit)) doubt(expected, matched);
  Registered found = judged(last, scan, expected, matched, odometry);
  if (measured) {
    found.innovation = normalized_innovation(*measured, found.state, matched.information);
  }
  found.inertial = inertial_after(reference, measured, matched, found);
  const Pose motion = reference.state.T_map_sensor.inverse() * found.state.T_map_sensor;
  found.against_map =
      found.is_registered ? drift.against_map(found.state) : grown(reference, found.state, motion);
  put_report(reference, scan, matched, found, notes);
  if (notes.trace != nullptr) {
    ScanTrace& trace = *notes.trace;
    trace.T_map_expected = expected.T_map_sensor;
    trace.T_map_odometry = odometry.T_map_sensor();
    trace.duration_s = duration_s;
    trace.sharp_edges = odometry.result().edge_correspondences;
    trace.flat_points = odometry.result().planar_correspondences;
    trace.last_inlier_ratio = last.inlier_ratio;
    trace_registration(mapping, scan.map_features, matched, trace);
  }
  notes.report.times.mapping_s += notes.stopwatch.lap_s();
  return found;
}

}  // namespace hqslam::slam
