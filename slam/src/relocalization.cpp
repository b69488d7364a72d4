// The state Searching: relocalization in a given map.

#include <optional>

#include "loops/loop_verification.h"
#include "map/choice_of_start.h"
#include "map/registration_trace.h"
#include "slam_implementation.h"

namespace hqslam::slam {

namespace {

/// Smallest overlap of a scan with a given map; simulated: 0.15 and more at the edge of the map,
/// 0.06 at a wrong place.
constexpr double kMinOverlapInGivenMap = 0.1;

/// A state at a recognized place, with the covariance of the recognition.
MotionState found_about(const Pose& T_map_sensor, const Twist& velocity) {
  constexpr double kAbout_m = 1.0;
  constexpr double kAbout_rad = 0.1;
  MotionState state = unknown_motion(T_map_sensor);
  state.velocity = velocity;
  state.covariance.diagonal().head<6>() = six(kAbout_m, kAbout_rad).cwiseAbs2();
  return state;
}

}  // namespace

/// Until the place is found the last known pose is reported, and the odometry goes on, so that
/// scans can be corrected for motion and moved together.
State Slam::Implementation::next(Searching now, const Scan& scan, Notes& notes) {
  ScanReport& report = notes.report;
  report.T_odom_sensor = now.T_odom_last;
  UnregisteredScan searched{scan.cloud, scan.map_features, {}, {}};
  if (now.reference) {
    const double duration_s = scan.time_s - now.reference->time_s;
    const OdometryResult moved =
        scan_to_scan(now.reference->target, scan.features,
                     {exponential(duration_s * now.reference->state.velocity), duration_s});
    report.odometry_status = moved.status;
    if (moved.status != Status::kTooFewFeatures) {
      searched.T_previous_sensor = moved.T_reference_sensor;
      searched.velocity = (1.0 / duration_s) * logarithm(moved.T_reference_sensor);
    }
    report.T_odom_sensor = orthonormalized(now.T_odom_last * moved.T_reference_sensor);
  }
  report.times.odometry_s = notes.stopwatch.lap_s();

  std::optional<Pose> T_map_sensor;
  if (scan.has_enough_features) T_map_sensor = place_recognition->find(searched, mapping.map());
  std::optional<MappingResult> matched;
  if (T_map_sensor) {
    matched =
        mapping.register_scan(scan.map_features, found_about(*T_map_sensor, searched.velocity),
                              *T_map_sensor, SearchFrom::kRecognizedPlace);
  }
  const bool is_found =
      matched && matched->close_ratio >= kLeastShareInGivenMap * now.usual_close_ratio;
  MotionState found = unknown_motion(is_found ? *T_map_sensor : now.T_map_last);
  found.velocity = searched.velocity;
  report.T_map_sensor = found.T_map_sensor;
  if (is_found) {
    map_fit.add(matched->close_ratio);
    found.covariance = matched->state.covariance;
    const Matrix6 against_map = drift.against_map(found);
    report.covariance = drift.covariance(Pose::Identity(), against_map);
    if (notes.trace != nullptr) {
      trace_registration(mapping, scan.map_features, *matched, *notes.trace);
    }
    return Tracking{.reference = reference_of(scan, found, against_map, report),
                    .close_ratio = matched->close_ratio,
                    .usual_close_ratio = matched->close_ratio};
  }
  report.mapping_status = Status::kNotRecognized;
  report.covariance = unknown_covariance();
  if (scan.has_enough_features) {
    now.reference = reference_of(scan, found, Matrix6::Zero(), report);
    now.T_odom_last = report.T_odom_sensor;
  }
  return now;
}

bool Slam::Implementation::is_in_given_map(const MapFeatures& features,
                                           const MotionState& found) const {
  return fit_of(features, mapping.map(), found).overlap >= kMinOverlapInGivenMap;
}

}  // namespace hqslam::slam
