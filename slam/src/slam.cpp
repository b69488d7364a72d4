#include "hqslam/slam/slam.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "alignment/drift.h"
#include "driven_path.h"
#include "front_end/mounting.h"
#include "front_end/scan_check.h"
#include "front_end/scan_clock.h"
#include "hqslam/core/error.h"
#include "hqslam/slam/features.h"
#include "hqslam/slam/mapping.h"
#include "hqslam/slam/odometry.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "hqslam/slam/segmentation.h"
#include "known_way.h"
#include "loops/background_loop_closing.h"
#include "loops/loop_verification.h"
#include "loops/place_recognition.h"
#include "map/choice_of_start.h"
#include "stopwatch.h"
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

/// In a given map a scan of which less stands where the map has something stands elsewhere: 0.15
/// and more at the edge of the map, 0.06 at a wrong place, measured. The ground fits everywhere.
constexpr double kMinOverlapInGivenMap = 0.1;

/// Whether a sensor that is not carried can have moved so much otherwise than it was expected to.
bool is_plausible(const Twist& surprise, double duration_s) {
  constexpr double kAccelerated_m_s2 = 10.0;
  constexpr double kTurned_rad_s2 = 5.0;
  const double half_square_s2 = 0.5 * duration_s * duration_s;
  return surprise.linear.norm() <= 0.5 + kAccelerated_m_s2 * half_square_s2 &&
         surprise.angular.norm() <= 0.2 + kTurned_rad_s2 * half_square_s2;
}

/// A state whose place was recognized: what was not measured yet is how well it is known.
MotionState found_about(MotionState state) {
  constexpr double kAbout_m = 1.0;
  constexpr double kAbout_rad = 0.1;
  state.covariance.diagonal().head<3>().setConstant(kAbout_m * kAbout_m);
  state.covariance.diagonal().segment<3>(3).setConstant(kAbout_rad * kAbout_rad);
  return state;
}

/// Whether a scan can serve as the one that the next are matched with: edges alone will do
/// (indoors), and so will ground and surfaces alone (in open land).
bool can_be_reference(const Features& features, const OdometryOptions& options) {
  return static_cast<int>(features.edges.size()) >= options.min_edges ||
         static_cast<int>(features.ground.size() + features.surfaces.size()) >= options.min_planar;
}

}  // namespace

/// What is carried from scan to scan. The reference is the last scan that could be followed.
struct Slam::Implementation {
  SlamOptions options;
  Mounting mounting;
  SensorModel sensor;  ///< the upright one
  Segmenter segmenter;
  Odometry odometry;
  Mapping mapping;
  std::optional<BackgroundLoopClosing> loop_closing;  ///< not in a given map
  DrivenPath path;
  ScanClock clock;
  double time_s = 0.0;  ///< of the scan at hand
  double reference_time_s = 0.0;
  MotionState reference;
  Pose T_odom_reference = Pose::Identity();
  AccelerationNoise accelerations;
  Drift drift;
  KnownWay way;

  Implementation(const SensorModel& sensor_, const SlamOptions& options_)
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

  /// In a map that another drive left behind: how its places are recognized.
  std::optional<PlaceRecognition> place_recognition;
  bool is_recognized = true;  ///< where the sensor is

  void locate_in(const SavedMap& map, const std::optional<Pose>& T_map_level_start);

  /// The first key frame, until its motion is known.
  struct FirstScan {
    double time_s = 0.0;
    Features features;
    MapFeatures thinned;
  };
  std::optional<FirstScan> first_scan;

  /// What is known of a scan after it was looked for.
  struct Followed {
    MotionState state;
    bool is_located = false;       ///< in the map
    bool by_odometry = false;      ///< from the reference
    bool is_way_measured = false;  ///< from the reference
    double standing_share = 0.0;   ///< see MappingResult
  };

  ScanReport process(const OrganizedCloud& cloud, double stamp_s);
  ScanReport process_level(const OrganizedCloud& cloud, double stamp_s);
  void begin(const OrganizedCloud& cloud, const Features& features, Stopwatch& stopwatch,
             ScanReport& report);
  void recognize_place(const OrganizedCloud& cloud, const Features& features, Stopwatch& stopwatch,
                       ScanReport& report);
  void follow(const OrganizedCloud& cloud, const Features& features, Stopwatch& stopwatch,
              ScanReport& report);
  Followed locate(const Features& features, const MapFeatures& thinned, Stopwatch& stopwatch,
                  ScanReport& report) const;
  void correct_first_key_frame(const Twist& velocity);
  void make_reference(const Features& features, const MotionState& state, const ScanReport& report);
  void add_key_frame(const OrganizedCloud& cloud, const MapFeatures& features, Stopwatch& stopwatch,
                     ScanReport& report, bool begins_stretch);
  void take_in(const LoopResult& found);
};

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
  path.add({stamp_s, report.T_map_sensor}, mapping.key_frames());
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
  if (!can_be_reference(features, options.odometry)) {
    report.odometry_status = Status::kTooFewFeatures;
    report.mapping_status = Status::kTooFewFeatures;
    return;
  }
  make_reference(features, unknown_motion(Pose::Identity()), report);
  first_scan = {time_s, features, map_features(features, sensor.measured_rows, options.mapping)};
  add_key_frame(cloud, first_scan->thinned, stopwatch, report, true);
}

/// Looks for the place of a scan in the given map. Until it is found the last known pose stands,
/// and the odometry goes on, so that scans can be corrected for motion and moved together.
void Slam::Implementation::recognize_place(const OrganizedCloud& cloud, const Features& features,
                                           Stopwatch& stopwatch, ScanReport& report) {
  MotionState state = unknown_motion(reference.T_map_sensor);
  report.T_odom_sensor = T_odom_reference;
  const MapFeatures thinned = map_features(features, sensor.measured_rows, options.mapping);
  UnlocatedScan scan{cloud, thinned, {}, {}};
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
  const bool is_seen_enough = can_be_reference(features, options.odometry);
  std::optional<Pose> T_map_sensor;
  if (is_seen_enough) T_map_sensor = place_recognition->find(scan, mapping.map());
  is_recognized = T_map_sensor.has_value();
  state.T_map_sensor = T_map_sensor.value_or(reference.T_map_sensor);
  state.velocity = scan.velocity;
  report.T_map_sensor = state.T_map_sensor;
  if (is_recognized) {
    state.covariance =
        mapping.locate(thinned, found_about(state), state.T_map_sensor).state.covariance;
    report.covariance = drift.covariance(Pose::Identity(), state);
  } else {
    report.mapping_status = Status::kNotRecognized;
    report.covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
  }
  if (is_seen_enough) make_reference(features, state, report);
  report.times.mapping_s = stopwatch.lap_s();
}

void Slam::Implementation::follow(const OrganizedCloud& cloud, const Features& features,
                                  Stopwatch& stopwatch, ScanReport& report) {
  const MapFeatures thinned = map_features(features, sensor.measured_rows, options.mapping);
  Followed followed = locate(features, thinned, stopwatch, report);
  if (first_scan && followed.is_located) {
    correct_first_key_frame(followed.state.velocity);
    followed = locate(features, thinned, stopwatch, report);
  }
  if (followed.is_located) {
    way.located(followed.standing_share);
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
  const bool goes_on = way.is_lost() && can_be_reference(features, options.odometry);
  if (followed.by_odometry || followed.is_located || goes_on) {
    const bool begins_stretch = goes_on && !way.is_measured() && !place_recognition;
    if (!followed.by_odometry && !followed.is_located) {
      // Nothing measured this motion: a wrong velocity would be predicted again, and kept for good.
      followed.state = unknown_motion(followed.state.T_map_sensor);
    }
    if (begins_stretch) {
      drift.lose(followed.state);
      first_scan.reset();
      path.begin_stretch(way.unlocated_scans() - 1, mapping.key_frames());
      way = {};
    }
    const Pose motion = reference.T_map_sensor.inverse() * followed.state.T_map_sensor;
    if (followed.is_located) {
      accelerations.learn(reference.velocity, followed.state.velocity, time_s - reference_time_s);
      drift.learn(followed.state.velocity);
    }
    if (followed.is_located && !place_recognition) {
      drift.locate(motion, followed.state);
    } else {
      drift.move(motion);
    }
    make_reference(features, followed.state, report);
    if (!place_recognition && (followed.is_located || goes_on) &&
        mapping.is_key_frame(report.T_map_sensor)) {
      add_key_frame(cloud, thinned, stopwatch, report, begins_stretch);
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

  MappingResult located = locate_from_both(mapping, thinned, {expected, T_map_moved, duration_s});
  if (place_recognition &&
      fit_of(thinned, mapping.map(), located.state.T_map_sensor).overlap < kMinOverlapInGivenMap) {
    located.status = Status::kTooFewFeatures;
  }
  const bool is_elsewhere = way.leads_elsewhere(located.standing_share);
  if (is_elsewhere) located.status = Status::kTooFewFeatures;
  if (located.status != Status::kTooFewFeatures &&
      duration_s > kSteady_periods * sensor.scan_period_s) {
    located.status = Status::kAfterGap;
  }
  Followed result{located.state, located.status != Status::kTooFewFeatures,
                  moved.status != Status::kTooFewFeatures, false, located.standing_share};
  const Twist surprise = logarithm(expected.T_map_sensor.inverse() * T_map_moved);
  result.is_way_measured =
      result.by_odometry && !is_elsewhere && is_plausible(surprise, duration_s);
  if (!result.is_located) {
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
void Slam::Implementation::correct_first_key_frame(const Twist& velocity) {
  mapping = Mapping(options.mapping);
  mapping.insert(first_scan->thinned, Pose::Identity(), velocity);
  if (reference_time_s == first_scan->time_s)
    odometry.set_reference(first_scan->features, velocity);
  first_scan.reset();
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
void Slam::Implementation::add_key_frame(const OrganizedCloud& cloud, const MapFeatures& features,
                                         Stopwatch& stopwatch, ScanReport& report,
                                         bool begins_stretch) {
  LoopKeyFrame key_frame{report.T_map_sensor, report.mapping_status, path.trajectory().size(),
                         begins_stretch, std::nullopt};
  if (begins_stretch || loop_closing->wants_view(report.T_map_sensor)) {
    key_frame.view = {cloud, features, reference.velocity,
                      begins_stretch ? mapping.lay_aside_all() : mapping.lay_aside()};
  }
  mapping.insert(features, report.T_map_sensor, reference.velocity);
  report.key_frame = true;
  report.times.mapping_s += stopwatch.lap_s();
  loop_closing->add(std::move(key_frame));
  report.times.loop_closing_s += stopwatch.lap_s();
}

/// Moves map and path with their key frames. The odometry's frame and the last motion stay as they
/// are, so the next scan is followed as if nothing had happened, in the corrected map.
void Slam::Implementation::take_in(const LoopResult& found) {
  path.join(found.part_of_stretch);
  if (!found.corrections.empty()) {
    mapping.correct(found.corrections);
    path.correct(found.corrections);
    reference.T_map_sensor = orthonormalized(found.corrections.back() * reference.T_map_sensor);
  }
  mapping.take_up(found.recalled);
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
  std::vector<LoopReport> reports;
  if (!implementation_->loop_closing) return reports;
  while (const auto found = implementation_->loop_closing->finish()) {
    implementation_->take_in(*found);
    reports.push_back(found->report);
  }
  return reports;
}

MountingOptions Slam::mounting() const { return implementation_->mounting.mounted(); }

const Trajectory& Slam::trajectory() const { return implementation_->path.trajectory(); }

const std::vector<std::size_t>& Slam::stretch_of_scan() const {
  return implementation_->path.stretch_of_scan();
}

std::vector<std::size_t> Slam::part_of_scan() const { return implementation_->path.part_of_scan(); }

std::vector<Eigen::Vector3f> Slam::map_points_m() const {
  const FeatureMaps& matched_with = implementation_->mapping.map();
  const auto& loop_closing = implementation_->loop_closing;
  std::vector<Eigen::Vector3f> result;
  for (const FeatureMaps& part : loop_closing ? loop_closing->whole_map(matched_with)
                                              : std::vector<FeatureMaps>{matched_with}) {
    for (const FeatureMap* kind : {&part.planes, &part.edges}) {
      const std::vector<Eigen::Vector3f> points_m = kind->points_m();
      result.insert(result.end(), points_m.begin(), points_m.end());
    }
  }
  return result;
}

SavedMap Slam::saved_map() const {
  const auto& loop_closing = implementation_->loop_closing;
  if (!loop_closing || !implementation_->options.loop_closing.enabled) {
    throw Error("expected loop closing, which knows the places of a map; switch it on");
  }
  const std::vector<FeatureMaps> parts = loop_closing->whole_map(implementation_->mapping.map());
  SavedMap result;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    std::vector<SavedPlace> places = loop_closing->finished().places(part);
    if (places.size() <= result.places.size()) continue;
    result = {parts[part].edges.points_m(), parts[part].posts.points_m(),
              parts[part].planes.points_m(), std::move(places)};
  }
  return result;
}

}  // namespace hqslam::slam
