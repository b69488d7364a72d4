// Locating in a map that another drive left behind.

#include <limits>
#include <optional>

#include "hqslam/core/error.h"
#include "hqslam/slam/saved_map.h"
#include "loops/loop_verification.h"
#include "slam_implementation.h"

namespace hqslam::slam {

namespace {

/// In a given map a scan of which less stands where the map has something stands elsewhere: 0.15
/// and more at the edge of the map, 0.06 at a wrong place, measured. The ground fits everywhere.
constexpr double kMinOverlapInGivenMap = 0.1;

/// A state whose place was recognized: what was not measured yet is how well it is known.
MotionState found_about(MotionState state) {
  constexpr double kAbout_m = 1.0;
  constexpr double kAbout_rad = 0.1;
  state.covariance.diagonal().head<3>().setConstant(kAbout_m * kAbout_m);
  state.covariance.diagonal().segment<3>(3).setConstant(kAbout_rad * kAbout_rad);
  return state;
}

}  // namespace

void Slam::Implementation::locate_in(const SavedMap& map,
                                     const std::optional<Pose>& T_map_level_start) {
  loop_closing.reset();  // a given map stays as it is
  if (map.places.empty()) {
    throw Error("the map has no place to be recognized; save it after a drive");
  }
  mapping = Mapping(options.mapping, FeatureMaps(options.mapping, map));
  place_recognition.emplace(options.mapping, map.places, T_map_level_start);
  is_recognized = false;
}

/// Looks for the place of a scan in the given map. Until it is found the last known pose stands,
/// and the odometry goes on, so that scans can be corrected for motion and moved together.
void Slam::Implementation::recognize_place(const OrganizedCloud& cloud, const Features& features,
                                           Stopwatch& stopwatch, ScanReport& report) {
  MotionState state = unknown_motion(reference.T_map_sensor);
  report.T_odom_sensor = T_odom_reference;
  const MapFeatures thinned = map_features(features, sensor.measured_rows, options.mapping);
  UnregisteredScan scan{cloud, thinned, {}, {}};
  if (odometry.has_reference()) {
    const double duration_s = time_s - reference_time_s;
    const OdometryResult moved =
        odometry.estimate(features, exponential(duration_s * reference.velocity), duration_s);
    report.odometry_status = moved.status;
    if (moved.status != Status::kTooFewFeatures) {
      scan.T_previous_sensor = moved.T_reference_sensor;
      scan.velocity = (1.0 / duration_s) * logarithm(moved.T_reference_sensor);
    }
    report.T_odom_sensor = orthonormalized(T_odom_reference * moved.T_reference_sensor);
  }
  report.times.odometry_s = stopwatch.lap_s();
  const bool is_seen_enough = can_be_reference(features);
  std::optional<Pose> T_map_sensor;
  if (is_seen_enough) T_map_sensor = place_recognition->find(scan, mapping.map());
  is_recognized = T_map_sensor.has_value();
  state.T_map_sensor = T_map_sensor.value_or(reference.T_map_sensor);
  state.velocity = scan.velocity;
  report.T_map_sensor = state.T_map_sensor;
  if (is_recognized) {
    state.covariance =
        mapping.register_scan(thinned, found_about(state), state.T_map_sensor).state.covariance;
    report.covariance = drift.covariance(Pose::Identity(), state);
  } else {
    report.mapping_status = Status::kNotRecognized;
    report.covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
  }
  if (is_seen_enough) make_reference(features, state, report);
  report.times.mapping_s = stopwatch.lap_s();
}

bool Slam::Implementation::is_in_given_map(const MapFeatures& thinned,
                                           const MotionState& state) const {
  return fit_of(thinned, mapping.map(), state).overlap >= kMinOverlapInGivenMap;
}

}  // namespace hqslam::slam
