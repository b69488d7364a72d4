// Tracking with an inertial sensor: whether it agrees with the scans, and registration without it.

#include <utility>
#include <vector>

#include "map/choice_of_start.h"
#include "slam_implementation.h"

namespace hqslam::slam {

namespace {

/// Whether a registration without the inertial sensor fits better than one with it.
bool is_better(const Registered& without, const Registered& with, double least_gain) {
  return without.is_registered &&
         (!with.is_registered || without.close_ratio > least_gain * with.close_ratio);
}

}  // namespace

/// Makes the scan what it was before make_turning_even().
void Slam::Implementation::leave_out_imu(Scan& scan) const {
  if (!scan.turning) return;
  scan.turning.reset();
  scan.features = measured_features(scan);
  scan.map_features = map_features(scan.features, mapping.options());
}

/// registered(), and without the inertial sensor if its prediction is contradicted: what fits
/// better is taken. The scan is then as it was measured.
Registered Slam::Implementation::checked(const Tracking& last, Scan& scan, Notes& notes) {
  Registered found = registered(last, scan, notes);
  const bool is_doubtful = !found.is_registered ||
                           found.innovation > InertialCheck::kMostInnovation ||
                           found.close_ratio < kDoubtfulFit * last.close_ratio;
  // A sensor that is not proven is left out unless the scan fits clearly better with it, and then,
  // too, where its prediction is so far off that the fit proves nothing.
  const bool is_proven = inertial_check.is_proven();
  const bool proves_nothing = found.innovation > InertialCheck::kMostInnovationUnproven;
  const double least_gain = is_proven ? 1.0 : proves_nothing ? 0.0 : 1.0 / kClearlyBetter;
  const bool competes = scan.turning && (is_doubtful || !is_proven);
  if (competes && replaced_without_imu(last, least_gain, scan, found, notes)) {
    if (is_proven) inertial_check.add_innovation(InertialCheck::kMostInnovation);
  } else if (notes.report.predicted_by_imu) {
    inertial_check.add_innovation(found.innovation);
    if (!is_proven && !proves_nothing) inertial_check.add_gain();
  }
  if (found.is_registered) compare_turns(last.reference, scan, found);
  return found;
}

/// Replaces a registration by one without the inertial sensor if that fits better, by at least
/// least_gain; returns whether it does.
bool Slam::Implementation::replaced_without_imu(const Tracking& last, double least_gain, Scan& scan,
                                                Registered& found, Notes& notes) {
  Scan alone = scan;
  leave_out_imu(alone);
  Notes alone_notes = notes;
  const Registered by_scan = registered(last, alone, alone_notes);
  if (is_better(by_scan, found, least_gain)) {
    leave_out_imu(scan);
    notes = alone_notes;
    found = by_scan;
    return true;
  }
  if (notes.trace != nullptr) found = registered(last, scan, notes);  // the trace is of this one
  return false;
}

/// Compares the turn since the reference by the inertial sensor with the registered one. Scans that
/// were registered without a sensor estimate no bias: that of a sensor which is proven now is set.
void Slam::Implementation::compare_turns(const Reference& reference, const Scan& scan,
                                         Registered& found) {
  const std::vector<ImuStep> steps =
      imu.steps(reference.stamp_s, scan.stamp_s, mounting.turn_to_level());
  if (steps.empty()) return;
  Eigen::Vector3d turned_rad = Eigen::Vector3d::Zero();
  for (const ImuStep& step : steps) turned_rad += step.duration_s * step.angular_rate_rad_per_s;
  const double duration_s = scan.stamp_s - reference.stamp_s;
  const Pose motion = reference.state.T_map_sensor.inverse() * found.state.T_map_sensor;
  const auto bias = inertial_check.compare_turns(
      {scan.stamp_s, turned_rad / duration_s, logarithm(motion).angular / duration_s});
  if (bias && found.inertial) {
    set_gyroscope_bias(*found.inertial, bias->rad_per_s, bias->duration_s);
  }
}

/// checked(), while the first keyframe is the only one in the better of two maps: it was corrected
/// with the turns of the inertial sensor, which nothing has confirmed yet, or is without. Wrong
/// turns smear both scans alike, which then fit each other: a contradicted prediction proves
/// nothing.
Registered Slam::Implementation::first_registered(Tracking& last, Scan& scan, Notes& notes) {
  if (!last.first_keyframe || !last.first_keyframe->turning ||
      last.first_keyframe->time_s != last.reference.time_s) {
    return in_corrected_map(last, scan, notes);
  }
  Tracking alone_last = last;
  Scan alone = scan;
  Notes alone_notes = notes;
  const Registered found = in_corrected_map(last, scan, notes);
  Mapping mapping_by_imu = mapping;
  leave_out_imu(alone);
  alone_last.first_keyframe->turning.reset();
  Reference& reference = alone_last.reference;
  reference.state = unknown_motion(reference.state.T_map_sensor);
  if (reference.inertial) reference.inertial = kept(*reference.inertial, reference.state);
  reference.target = {put_first_keyframe(*alone_last.first_keyframe, Twist()), ScanMotion()};
  const Registered by_scan = in_corrected_map(alone_last, alone, alone_notes);
  if (found.innovation < InertialCheck::kMostInnovation &&
      is_better(found, by_scan, kClearlyBetter)) {
    mapping = std::move(mapping_by_imu);
    return found;
  }
  last = std::move(alone_last);
  leave_out_imu(scan);
  notes = alone_notes;
  return by_scan;
}

}  // namespace hqslam::slam
