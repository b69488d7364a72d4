#include "hqslam/slam/slam.h"

#include "front_end/scan_check.h"
#include "map/choice_of_start.h"
#include "slam_implementation.h"
#include "thread_limit.h"

namespace hqslam::slam {

namespace {

SensorModel validated(const SensorModel& sensor) {
  hqslam::validate(sensor);
  return sensor;
}

SlamOptions validated(const SlamOptions& options) {
  validate(options);
  return options;
}

/// A sensor that is followed no longer is believed to keep its velocity for so long.
constexpr double kSteady_periods = 10.0;

/// Whether a sensor that is not carried can have moved so much otherwise than it was expected to.
bool is_plausible(const Twist& innovation, double duration_s) {
  constexpr double kAccelerated_m_s2 = 10.0;
  constexpr double kTurned_rad_s2 = 5.0;
  const double half_square_s2 = 0.5 * duration_s * duration_s;
  return innovation.linear.norm() <= 0.5 + kAccelerated_m_s2 * half_square_s2 &&
         innovation.angular.norm() <= 0.2 + kTurned_rad_s2 * half_square_s2;
}

}  // namespace

Slam::Implementation::Implementation(const SensorModel& sensor_, const SlamOptions& options_)
    : options(validated(options_)),
      mounting(options.mounting, validated(sensor_)),
      sensor(mounting.upright_sensor()),
      segmenter(sensor, options.ground, options.segmentation),
      odometry(options.odometry),
      mapping(options.mapping),
      clock(sensor.scan_period_s),
      drift(sensor) {
  loop_closing.emplace(options.mapping, options.loop_closing.enabled);
}

/// All that process_level() knows of is the sensor turned level.
ScanReport Slam::Implementation::process(const OrganizedCloud& cloud, double stamp_s) {
  if (options.mounting.estimated && !mounting.mounted().estimated && !odometry.has_reference()) {
    mounting.estimate(cloud);
  }
  const std::optional<OrganizedCloud> level = mounting.level(cloud);
  ScanReport report = process_level(level ? *level : cloud, stamp_s);
  report.T_map_sensor = mounting.of_sensor(report.T_map_sensor);
  report.T_odom_sensor = mounting.of_sensor(report.T_odom_sensor);
  report.covariance = mounting.of_sensor(report.covariance);
  path.add({stamp_s, report.T_map_sensor}, mapping.keyframes());
  return report;
}

ScanReport Slam::Implementation::process_level(const OrganizedCloud& cloud, double stamp_s) {
  Stopwatch stopwatch;
  ScanReport report;
  report.stamp_s = stamp_s;
  time_s = clock.time_s(stamp_s);
  if (loop_closing) {
    if (const std::optional<LoopResult> found = loop_closing->collect()) {
      take_in(*found);
      report.loop = found->report;
    }
    report.times.loop_closing_s = stopwatch.lap_s();
  }
  const Segmentation segmentation = segmenter.segment(cloud, mounting.up_of_upright_sensor());
  report.returns = segmentation.returns;
  report.ground_points = segmentation.ground_points;
  report.clusters = segmentation.clusters;
  report.times.segmentation_s = stopwatch.lap_s();

  const Features features = extract_features(cloud, segmentation, options.features);
  report.edge_features = static_cast<int>(features.edges.size());
  report.planar_features = static_cast<int>(features.ground.size() + features.surfaces.size());
  report.times.features_s = stopwatch.lap_s();

  if (!is_recognized) {
    recognize_place(cloud, features, stopwatch, report);
  } else if (odometry.has_reference()) {
    follow(cloud, features, stopwatch, report);
  } else {
    begin(cloud, features, stopwatch, report);
  }
  report.times.total_s = report.times.segmentation_s + report.times.features_s +
                         report.times.odometry_s + report.times.mapping_s +
                         report.times.loop_closing_s;
  return report;
}

/// The first scan with enough features defines the frame of the map.
void Slam::Implementation::begin(const OrganizedCloud& cloud, const Features& features,
                                 Stopwatch& stopwatch, ScanReport& report) {
  if (!can_be_reference(features)) {
    report.odometry_status = Status::kTooFewFeatures;
    report.mapping_status = Status::kTooFewFeatures;
    return;
  }
  make_reference(features, unknown_motion(Pose::Identity()), report);
  first_scan = {time_s, features, map_features(features, sensor.measured_rows, options.mapping)};
  add_keyframe(cloud, first_scan->thinned, stopwatch, report, true);
}

void Slam::Implementation::follow(const OrganizedCloud& cloud, const Features& features,
                                  Stopwatch& stopwatch, ScanReport& report) {
  const MapFeatures thinned = map_features(features, sensor.measured_rows, options.mapping);
  Followed followed = locate(features, thinned, stopwatch, report);
  if (first_scan && followed.is_registered) {
    correct_first_keyframe(followed.state.velocity);
    followed = locate(features, thinned, stopwatch, report);
  }
  if (followed.is_registered) {
    way.located(followed.inlier_ratio);
  } else {
    way.not_located(followed.is_way_measured);
  }
  if (place_recognition && way.is_lost()) {
    is_recognized = false;  // the next scan is looked for in all of the map
    place_recognition->forget();
    odometry = Odometry(options.odometry);
    way = {};
    return;
  }
  const bool goes_on = way.is_lost() && can_be_reference(features);
  if (followed.by_odometry || followed.is_registered || goes_on) {
    const bool begins_segment = goes_on && !way.is_measured() && !place_recognition;
    if (!followed.by_odometry && !followed.is_registered) {
      // Nothing measured this motion: a wrong velocity would be predicted again, and kept for good.
      followed.state = unknown_motion(followed.state.T_map_sensor);
    }
    if (begins_segment) {
      drift.lose(followed.state);
      path.begin_segment(way.unlocated_scans() - 1, mapping.keyframes());
      way = {};
    }
    const Pose motion = reference.T_map_sensor.inverse() * followed.state.T_map_sensor;
    if (followed.is_registered) {
      accelerations.learn(reference.velocity, followed.state.velocity, time_s - reference_time_s);
      drift.learn(followed.state.velocity);
    }
    if (followed.is_registered && !place_recognition) {
      drift.grow(motion, followed.state);
    } else {
      drift.move(motion);
    }
    make_reference(features, followed.state, report);
    const bool is_farther =
        (followed.is_registered || goes_on) && mapping.is_keyframe(report.T_map_sensor);
    if (!place_recognition && (begins_segment || is_farther)) {
      first_scan.reset();  // no longer the only keyframe: the map cannot begin anew with it
      add_keyframe(cloud, thinned, stopwatch, report, begins_segment);
    }
  }
  report.times.mapping_s += stopwatch.lap_s();
}

/// Where the scan is, by the odometry and in the map, the last one that was followed being the
/// reference.
Slam::Implementation::Followed Slam::Implementation::locate(const Features& features,
                                                            const MapFeatures& thinned,
                                                            Stopwatch& stopwatch,
                                                            ScanReport& report) const {
  const double duration_s = time_s - reference_time_s;
  const MotionState expected = predicted(
      reference, duration_s, kSteady_periods * sensor.scan_period_s, accelerations.density());
  const OdometryResult moved = odometry.estimate(
      features, reference.T_map_sensor.inverse() * expected.T_map_sensor, duration_s);
  const Pose T_map_moved = orthonormalized(reference.T_map_sensor * moved.T_reference_sensor);
  report.odometry_status = moved.status;
  report.T_odom_sensor = orthonormalized(T_odom_reference * moved.T_reference_sensor);
  report.times.odometry_s += stopwatch.lap_s();

  MappingResult located = register_from_both(mapping, thinned, {expected, T_map_moved, duration_s});
  if (place_recognition && !is_in_given_map(thinned, located.state)) {
    located.status = Status::kTooFewFeatures;
  }
  const bool is_elsewhere = way.leads_elsewhere(located.inlier_ratio);
  if (is_elsewhere) located.status = Status::kTooFewFeatures;
  if (located.status != Status::kTooFewFeatures &&
      duration_s > kSteady_periods * sensor.scan_period_s) {
    located.status = Status::kAfterGap;
  }
  Followed result{located.state, located.status != Status::kTooFewFeatures,
                  moved.status != Status::kTooFewFeatures, false, located.inlier_ratio};
  const Twist innovation = logarithm(expected.T_map_sensor.inverse() * T_map_moved);
  result.is_way_measured =
      result.by_odometry && !is_elsewhere && is_plausible(innovation, duration_s);
  if (!result.is_registered) {
    result.state.T_map_sensor = T_map_moved;
    result.state.velocity = (1.0 / duration_s) * logarithm(moved.T_reference_sensor);
  }
  report.mapping_status = located.status;
  report.edge_correspondences = located.edge_correspondences;
  report.planar_correspondences = located.planar_correspondences;
  report.T_map_sensor = result.state.T_map_sensor;
  report.covariance =
      drift.covariance(reference.T_map_sensor.inverse() * result.state.T_map_sensor, result.state);
  report.times.mapping_s += stopwatch.lap_s();
  return result;
}

/// The first scan was taken as if the sensor stood: now that its velocity is known it is corrected
/// for that, and the map begins anew with it.
void Slam::Implementation::correct_first_keyframe(const Twist& velocity) {
  mapping = Mapping(options.mapping);
  mapping.insert(first_scan->thinned, Pose::Identity(), velocity);
  if (reference_time_s == first_scan->time_s)
    odometry.set_reference(first_scan->features, velocity);
  first_scan.reset();
}

bool Slam::Implementation::can_be_reference(const Features& features) const {
  const OdometryOptions& wanted = options.odometry;
  return static_cast<int>(features.edges.size()) >= wanted.min_edges ||
         static_cast<int>(features.ground.size() + features.surfaces.size()) >= wanted.min_planar;
}

/// Makes this scan, of which the poses are known, the one that the next are matched with.
void Slam::Implementation::make_reference(const Features& features, const MotionState& state,
                                          const ScanReport& report) {
  reference = state;
  odometry.set_reference(features, state.velocity);
  reference_time_s = time_s;
  T_odom_reference = report.T_odom_sensor;
}

/// Puts the scan, of which velocity and T_map_sensor are known, into the map, or into one of its
/// own if nothing measured the way here.
void Slam::Implementation::add_keyframe(const OrganizedCloud& cloud, const MapFeatures& features,
                                        Stopwatch& stopwatch, ScanReport& report,
                                        bool begins_segment) {
  LoopKeyframe keyframe{report.T_map_sensor, report.mapping_status, path.trajectory().size(),
                        begins_segment, std::nullopt};
  if (begins_segment || loop_closing->wants_view(report.T_map_sensor)) {
    keyframe.view = {cloud, features, reference.velocity,
                     begins_segment ? mapping.clear_window() : mapping.slide_window()};
  }
  mapping.insert(features, report.T_map_sensor, reference.velocity);
  report.keyframe = true;
  report.times.mapping_s += stopwatch.lap_s();
  loop_closing->add(std::move(keyframe));
  report.times.loop_closing_s += stopwatch.lap_s();
}

/// Moves map and path with their keyframes. The odometry's frame and the last motion stay as they
/// are, so the next scan is followed as if nothing had happened, in the corrected map.
void Slam::Implementation::take_in(const LoopResult& found) {
  path.join(found.submap_of_segment);
  if (!found.corrections.empty()) {
    mapping.correct(found.corrections);
    path.correct(found.corrections);
    reference.T_map_sensor = orthonormalized(found.corrections.back() * reference.T_map_sensor);
  }
  mapping.restore_to_window(found.recalled);
}

Slam::Slam(const SensorModel& sensor) : Slam(sensor, SlamOptions{}) {}
Slam::Slam(const SensorModel& sensor, const SlamOptions& options)
    : implementation_(std::make_unique<Implementation>(sensor, options)) {}
Slam::Slam(const SensorModel& sensor, const SlamOptions& options, const SavedMap& map,
           const std::optional<Pose>& T_map_level_start)
    : Slam(sensor, options) {
  implementation_->locate_in(map, T_map_level_start);
}
Slam::~Slam() = default;
Slam::Slam(Slam&&) noexcept = default;
Slam& Slam::operator=(Slam&&) noexcept = default;

ScanReport Slam::process(const OrganizedCloud& cloud, double stamp_s) {
  check(cloud, stamp_s, implementation_->sensor);
  const ThreadLimit limit(implementation_->options.threads);
  return all_sound(cloud) ? implementation_->process(cloud, stamp_s)
                          : implementation_->process(without_unsound(cloud), stamp_s);
}

std::vector<LoopReport> Slam::finish() {
  const ThreadLimit limit(implementation_->options.threads);
  std::vector<LoopReport> reports;
  if (!implementation_->loop_closing) return reports;
  while (const auto found = implementation_->loop_closing->finish()) {
    implementation_->take_in(*found);
    reports.push_back(found->report);
  }
  return reports;
}

}  // namespace hqslam::slam
