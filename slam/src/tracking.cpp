// The states Starting, Tracking and Lost.

#include <algorithm>
#include <array>
#include <utility>

#include "map/choice_of_start.h"
#include "slam_implementation.h"

namespace hqslam::slam {

namespace {

/// Consecutive scans that may miss the map.
constexpr std::size_t kMaxMissedScans = 5;
/// The place has changed if less than this share of what matched is close to the map: a lorry
/// stopped beside the sensor, a crowd arrived (simulated scenes; no real recording changes).
constexpr double kChangedShare = 0.8;
/// Between a scan and the one with the best fit since the last keyframe, if the sensor stands.
constexpr double kStands_m = 0.05;
constexpr double kStands_rad = 0.02;
/// Decay of Tracking::usual_close_ratio with each scan that fits less well (a real OS0 in a hand).
constexpr double kForgotten = 0.1;
/// Of the first keyframe, for motion: simulated starts need 1 to 8.
constexpr int kMostCorrections = 10;
/// Share of the change of velocity that the next correction follows. Full steps swing about the
/// result: a keyframe that was corrected for too large a velocity makes the next one too small.
constexpr double kCorrectionStep = 2.0 / 3.0;

/// Whether a change of velocity (linear, angular) moves no point of a scan by millimetres.
bool is_slight(const Vector6& change) {
  constexpr double kSlight_mps = 0.02;
  constexpr double kSlight_rad_per_s = 0.002;
  return change.head<3>().norm() < kSlight_mps && change.tail<3>().norm() < kSlight_rad_per_s;
}

}  // namespace

Reference reference_of(const Scan& scan, const MotionState& state, const Matrix6& against_map,
                       const ScanReport& report, std::optional<InertialState> inertial) {
  if (!inertial && scan.turning) inertial = first_inertial_state(state, scan.specific_force_mps2);
  return {scan.time_s,
          state,
          against_map,
          report.T_odom_sensor,
          {scan.features, state.within_scan()},
          scan.stamp_s,
          std::move(inertial)};
}

std::string_view name(const State& state) {
  constexpr std::array<std::string_view, 4> kNames = {"starting", "tracking", "lost", "searching"};
  return kNames[state.index()];
}

Reference* reference_of(State& state) {
  if (auto* tracking = std::get_if<Tracking>(&state)) return &tracking->reference;
  if (auto* lost = std::get_if<Lost>(&state)) return &lost->last.reference;
  auto* searching = std::get_if<Searching>(&state);
  return searching != nullptr && searching->reference ? &*searching->reference : nullptr;
}

FirstKeyframe Slam::Implementation::first_keyframe_of(const Scan& scan,
                                                      const Pose& T_map_sensor) const {
  return {scan.time_s, T_map_sensor, scan.turning ? measured_features(scan) : scan.features,
          scan.turning};
}

/// The first scan with enough features defines the frame of the map.
State Slam::Implementation::next(Starting, const Scan& scan, Notes& notes) {
  notes.report.covariance = drift.covariance(Pose::Identity(), Matrix6::Zero());
  if (!scan.has_enough_features) {
    notes.report.odometry_status = Status::kTooFewFeatures;
    notes.report.mapping_status = Status::kTooFewFeatures;
    return Starting{};
  }
  MotionState standing = unknown_motion(Pose::Identity());
  if (scan.turning) standing.velocity.angular = scan.turning->mean_rate_rad_per_s();
  add_keyframe(scan, standing.within_scan(), true, notes);
  return Tracking{
      .reference = reference_of(scan, standing, drift.against_map(standing), notes.report),
      .first_keyframe = first_keyframe_of(scan, standing.T_map_sensor)};
}

State Slam::Implementation::next(Tracking now, Scan& scan, Notes& notes) {
  return next(Lost{std::move(now)}, scan, notes);
}

State Slam::Implementation::next(Lost now, Scan& scan, Notes& notes) {
  const Registered found = first_registered(now.last, scan, notes);
  if (found.is_registered) return tracked(std::move(now.last), found, scan, notes);
  gravity_window.interrupt();
  ++now.missed_scans;
  ++now.unplaced_scans;
  now.is_motion_measured = now.is_motion_measured && found.is_motion_plausible;
  now.is_carried = now.is_carried || found.is_contradiction;
  const bool is_lost = now.missed_scans > kMaxMissedScans;
  const Reference& reference = now.last.reference;
  if (is_lost && place_recognition) {
    place_recognition->forget();
    return Searching{reference.state.T_map_sensor, notes.report.T_odom_sensor, std::nullopt,
                     now.last.usual_close_ratio};
  }
  const bool map_goes_on = is_lost && scan.has_enough_features;
  if (map_goes_on && !now.is_motion_measured) return new_segment(now, found, scan, notes);
  if (!found.by_odometry) return now;
  drift.move(reference.state.T_map_sensor.inverse() * found.state.T_map_sensor);
  now.last.reference =
      reference_of(scan, found.state, found.against_map, notes.report, found.inertial);
  if (map_goes_on && is_keyframe(now.last, found.state.T_map_sensor)) {
    add_keyframe(scan, found.state.within_scan(), false, notes);
    if (!is_precise(found.state)) drift.add_uncertain_keyframe(found.against_map);
    now.unplaced_scans = 0;
  }
  return now;
}

/// Whether the scan becomes a keyframe: because the sensor has moved, or because the place has
/// changed around it.
bool Slam::Implementation::is_keyframe(Tracking& last, const Pose& T_map_sensor) const {
  BestFit& best = last.best_fit;
  const Pose motion = best.T_map_sensor.inverse() * T_map_sensor;
  const bool stands =
      motion.translation().norm() < kStands_m && rotation_angle_rad(motion) < kStands_rad;
  const bool has_changed = stands && last.close_ratio < kChangedShare * best.close_ratio;
  const bool is_keyframe = has_changed || mapping.is_keyframe(T_map_sensor);
  if (is_keyframe || !stands || last.close_ratio > best.close_ratio) {
    best = {is_keyframe ? 0.0 : last.close_ratio, T_map_sensor};
  }
  // No longer the only one: the map cannot begin anew with it.
  if (is_keyframe) last.first_keyframe.reset();
  return is_keyframe;
}

/// After Tracking or Lost: the scan was registered.
State Slam::Implementation::tracked(Tracking last, const Registered& found, const Scan& scan,
                                    Notes& notes) {
  const MotionState& before = last.reference.state;
  const Pose motion = before.T_map_sensor.inverse() * found.state.T_map_sensor;
  // A velocity that was predicted, not measured, shows no acceleration.
  if (notes.report.mapping_status != Status::kDegenerate) {
    accelerations.learn(before.velocity, found.state.velocity, scan.time_s - last.reference.time_s);
  }
  drift.learn(found.state.velocity);
  if (place_recognition) {
    drift.move(motion);
  } else {
    const bool is_by_gravity = found.inertial && inertial_check.can_level();
    const bool is_held = found.has_near_ground || rooms.is_in_room();
    drift.grow(motion, found.state,
               is_by_gravity ? Drift::Level::kByGravity
               : is_held     ? Drift::Level::kByGround
                             : Drift::Level::kByNothing);
  }
  const bool is_known = is_precise(found.state);
  if (drift.inherit_uncertainty(found.against_map, is_known)) {
    notes.report.covariance = drift.covariance(Pose::Identity(), found.against_map);
  }
  last.reference = reference_of(scan, found.state, found.against_map, notes.report, found.inertial);
  if (last.reference.inertial) {
    gravity_window.add({scan.stamp_s, found.state.T_map_sensor},
                       last.reference.inertial->gyroscope_bias_rad_per_s);
  } else {
    gravity_window.interrupt();
  }
  if (!inertial_check.agrees()) gravity_window = {};
  last.inlier_ratio = found.inlier_ratio;
  last.close_ratio = found.close_ratio;
  map_fit.add(found.close_ratio);
  last.usual_close_ratio =
      std::max(last.close_ratio,
               last.usual_close_ratio + kForgotten * (last.close_ratio - last.usual_close_ratio));
  if (!place_recognition && is_keyframe(last, found.state.T_map_sensor)) {
    add_keyframe(scan, found.state.within_scan(), false, notes);
    if (!is_known) drift.add_uncertain_keyframe(found.against_map);
  }
  return last;
}

/// After Lost: the motion is unknown. Tracking continues from the estimated pose in a submap of its
/// own.
State Slam::Implementation::new_segment(const Lost& lost, Registered found, const Scan& scan,
                                        Notes& notes) {
  drift.move(lost.last.reference.state.T_map_sensor.inverse() * found.state.T_map_sensor);
  drift.lose(found.against_map, lost.is_carried);
  // An unmeasured velocity would be predicted again and never corrected.
  if (!found.by_odometry) {
    found.state = unknown_motion(found.state.T_map_sensor);
    if (found.inertial) found.inertial = kept(*found.inertial, found.state);
  }
  path.begin_segment(lost.unplaced_scans - 1, mapping.keyframes(), lost.is_carried);
  const Matrix6 against_own_map = drift.against_map(unknown_motion(found.state.T_map_sensor));
  notes.own_covariance = drift.own_covariance(Pose::Identity(), against_own_map);
  notes.report.covariance = drift.covariance(Pose::Identity(), against_own_map);
  add_keyframe(scan, found.state.within_scan(), true, notes);
  Tracking begun{
      .reference = reference_of(scan, found.state, against_own_map, notes.report, found.inertial)};
  if (!found.by_odometry) begun.first_keyframe = first_keyframe_of(scan, found.state.T_map_sensor);
  return begun;
}

/// checked(), and again after the map has begun anew with the first keyframe, which was inserted as
/// if the sensor stood, corrected for the velocity that is known now: until that no longer changes.
Registered Slam::Implementation::in_corrected_map(Tracking& last, Scan& scan, Notes& notes) {
  Registered found = checked(last, scan, notes);
  if (!last.first_keyframe || !found.is_registered) return found;
  Twist velocity = found.state.velocity;
  for (int i = 0; i < kMostCorrections; ++i) {
    correct_first_keyframe(last, velocity);
    last.first_keyframe->T_map_next = found.state.T_map_sensor;
    found = registered(last, scan, notes);
    const Vector6 change = vector_of(found.state.velocity) - vector_of(velocity);
    if (!found.is_registered || is_slight(change)) break;
    velocity = twist_of(vector_of(velocity) + kCorrectionStep * change);
  }
  last.first_keyframe.reset();
  return found;
}

/// Begins the map anew with the first keyframe alone. Returns its features.
Features Slam::Implementation::put_first_keyframe(const FirstKeyframe& first,
                                                  const Twist& velocity) {
  Features features = first.measured_features;
  if (first.turning) first.turning->apply(features);
  mapping = Mapping(mapping.options(), mapping.keyframes() - 1);
  mapping.insert(map_features(features, mapping.options()), first.T_map_sensor, {velocity});
  return features;
}

void Slam::Implementation::correct_first_keyframe(Tracking& last, Twist velocity) {
  const FirstKeyframe& first = *last.first_keyframe;
  if (first.turning) velocity.angular = first.turning->mean_rate_rad_per_s();
  const Features features = put_first_keyframe(first, velocity);
  if (last.reference.time_s == first.time_s) last.reference.target = {features, {velocity}};
}

/// Inserts the scan at the pose of the report into the map, or into a submap of its own if it
/// begins a segment.
void Slam::Implementation::add_keyframe(const Scan& scan, const ScanMotion& motion,
                                        bool begins_segment, Notes& notes) {
  ScanReport& report = notes.report;
  LoopKeyframe keyframe{report.T_map_sensor,
                        report.mapping_status,
                        path.trajectory().size(),
                        begins_segment,
                        drift.state(),
                        std::nullopt,
                        {},
                        scan.turning.has_value()};
  if (begins_segment || loop_closing->wants_view(report.T_map_sensor)) {
    keyframe.view = {scan.cloud, scan.map_features, motion,
                     begins_segment ? mapping.clear_window() : mapping.slide_window()};
    gravity_window.end(keyframe.scan, imu, mounting.turn_to_level());
    if (inertial_check.can_level()) keyframe.gravity = gravity_window.take();
  }
  mapping.insert(scan.map_features, report.T_map_sensor, motion);
  report.keyframe = true;
  report.times.mapping_s += notes.stopwatch.lap_s();
  loop_closing->add(std::move(keyframe));
  report.times.loop_closing_s += notes.stopwatch.lap_s();
}

}  // namespace hqslam::slam
