#include "hqslam/slam/slam.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "check_option.h"
#include "front_end/ground.h"
#include "front_end/scan_check.h"
#include "front_end/scattered_returns.h"
#include "hqslam/core/error.h"
#include "hqslam/slam/saved_map.h"
#include "map/registration_trace.h"
#include "slam_implementation.h"
#include "thread_limit.h"

namespace hqslam::slam {

namespace {

/// Inertial data are kept this long, and not integrated across longer gaps.
constexpr double kImuMemory_s = 5.0;

FeatureMaps map_of(const SlamOptions& options, const SavedMap* given_map) {
  if (given_map == nullptr) return FeatureMaps(options.mapping);
  if (given_map->places.empty()) {
    throw Error("expected a map with places, found none; save the map after a drive");
  }
  return {in_rooms(options.mapping), *given_map};  // the smaller voxels keep the points of either
}

/// A cloud in the frame in which `up` is the vertical.
OrganizedCloud turned_level(OrganizedCloud cloud, const Eigen::Vector3d& up) {
  const Eigen::Matrix3f R = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ())
                                .toRotationMatrix()
                                .cast<float>();
  for (Eigen::Vector3f& point_m : cloud.points_m) point_m = R * point_m;
  return cloud;
}

int returns_in(const OrganizedCloud& cloud) {
  return static_cast<int>(
      std::ranges::count_if(cloud.range_m, [](float range_m) { return range_m > 0.0F; }));
}

}  // namespace

Slam::Implementation::Implementation(const SensorModel& sensor_, const SlamOptions& options_,
                                     const SavedMap* given_map,
                                     const std::optional<Pose>& T_map_level_start)
    : options(validated(options_)),
      mounting(options.mounting, validated(sensor_)),
      sensor(mounting.upright_sensor()),
      clock(sensor.scan_period_s),
      mapping(options.mapping, map_of(options, given_map)),
      drift(sensor) {
  if (given_map == nullptr) {
    loop_closing.emplace(options.mapping, options.loop_closing.enabled);
  } else {
    place_recognition.emplace(options.mapping, given_map->places, T_map_level_start);
    state = Searching{};
    map_fit = MapFit(given_map->close_ratio);
  }
}

/// Processes a scan in the level frame.
Notes Slam::Implementation::process_level(const OrganizedCloud& cloud, double stamp_s,
                                          ScanTrace* trace) {
  Notes notes;
  notes.trace = trace;
  notes.report.stamp_s = stamp_s;
  collect_loops(notes);
  const std::optional<OrganizedCloud> clear = without_scattered(cloud);
  if (clear) notes.report.scattered = returns_in(cloud) - returns_in(*clear);
  Scan scan = front_end(clear ? *clear : cloud, stamp_s, notes);
  const std::string_view state_before = name(state);
  state = std::visit([&](auto& now) { return next(std::move(now), scan, notes); }, state);
  if (is_registered(notes.report.mapping_status) && map_fit.is_doubtful()) {
    notes.report.mapping_status = Status::kMapInDoubt;
  }
  if (trace != nullptr) {
    trace->state_before = state_before;
    trace->state = name(state);
    trace->T_map_level = notes.report.T_map_sensor;
  }
  const Reference* reference = reference_of(state);
  const bool is_followed = reference != nullptr && reference->time_s == scan.time_s;
  const MotionState motion = is_followed ? reference->state : unknown_motion(Pose::Identity());
  notes.report.velocity = motion.velocity;
  notes.report.velocity_covariance = motion.covariance.bottomRightCorner<6, 6>();
  StageTimes& times = notes.report.times;
  times.mapping_s += notes.stopwatch.lap_s();
  times.total_s = times.segmentation_s + times.features_s + times.odometry_s + times.mapping_s +
                  times.loop_closing_s;
  return notes;
}

/// Converts between the frame of the sensor and the level frame of process_level().
ScanReport Slam::Implementation::process(const OrganizedCloud& cloud, double stamp_s,
                                         ScanTrace* trace) {
  if (!path.trajectory().empty() && stamp_s < path.trajectory().back().stamp_s) {
    imu = {};  // the clock was set back: stamps before are of another clock
    gravity_window.interrupt();
  }
  if (!mounting.is_compared() && reference_of(state) == nullptr)
    mounting.correct_from_ground(cloud);
  const std::optional<OrganizedCloud> level = mounting.level(cloud);
  Notes notes = process_level(level ? *level : cloud, stamp_s, trace);
  ScanReport& report = notes.report;
  report.T_map_sensor = mounting.of_sensor(report.T_map_sensor);
  report.T_odom_sensor = mounting.of_sensor(report.T_odom_sensor);
  report.covariance = mounting.of_sensor(report.covariance);
  report.velocity = mounting.of_sensor(report.velocity);
  report.velocity_covariance = mounting.of_sensor(report.velocity_covariance);
  path.add({stamp_s, report.T_map_sensor}, mapping.keyframes(),
           mounting.of_sensor(notes.own_covariance));
  imu.forget_before(stamp_s - kImuMemory_s);
  return report;
}

Scan Slam::Implementation::front_end(const OrganizedCloud& cloud, double stamp_s, Notes& notes) {
  ScanReport& report = notes.report;
  const double time_s = clock.time_s(stamp_s);
  Scan scan{cloud, segmented(cloud, time_s), time_s, stamp_s};
  report.returns = scan.segmentation.returns;
  report.ground_points = scan.segmentation.ground_points;
  report.times.segmentation_s = notes.stopwatch.lap_s();

  scan.features = measured_features(scan);
  make_turning_even(scan);
  if (rooms.add(scan.features.surfaces)) {
    mapping.change_options(rooms.is_in_room() ? in_rooms(options.mapping) : options.mapping);
  }
  scan.map_features = map_features(scan.features, mapping.options());
  const auto planar = static_cast<int>(scan.features.ground.size() + scan.features.surfaces.size());
  report.edge_features = static_cast<int>(scan.features.edges.size());
  report.planar_features = planar;
  scan.has_enough_features = report.edge_features >= kFewestEdges || planar >= kFewestPlanar;
  report.times.features_s = notes.stopwatch.lap_s();
  if (notes.trace != nullptr) {
    notes.trace->cloud = cloud;
    notes.trace->pixel_class = scan.segmentation.pixel_class;
    trace_features(scan.map_features, *notes.trace);
  }
  return scan;
}

/// A mounting that was estimated from the first scan of a sensor in hands is its posture in that
/// scan. Where the map's vertical and that of the level frame differ by more than the steepest
/// ground, that which shows more ground is right: the map's for hands, the other on a slope.
Segmentation Slam::Implementation::segmented(const OrganizedCloud& cloud, double time_s) {
  Segmentation by_sensor = segment(cloud, sensor, mounting.up_of_upright_sensor());
  const Reference* reference = reference_of(state);
  if (!mounting.mounted().estimated || reference == nullptr) return by_sensor;
  const Eigen::Vector3d turn_rad = (time_s - reference->time_s) * reference->state.velocity.angular;
  const Eigen::Vector3d up = exponential({Eigen::Vector3d::Zero(), turn_rad}).linear().transpose() *
                             reference->state.T_map_sensor.linear().row(2).transpose();
  if (up.z() > std::cos(kMaxGroundSlope_rad)) return by_sensor;
  const OrganizedCloud level = turned_level(cloud, up);
  Segmentation by_map = segment(level, sensor, mounting.up_of_upright_sensor(up));
  by_map.up = up;
  if (by_map.ground_points > by_sensor.ground_points) return by_map;
  return by_sensor;
}

Features Slam::Implementation::measured_features(const Scan& scan) const {
  return extract_features(scan.cloud, scan.segmentation, sensor.measured_rows);
}

/// Applies EvenTurning to a scan that inertial data cover, of a sensor that agrees with the scans.
void Slam::Implementation::make_turning_even(Scan& scan) {
  if (!inertial_check.agrees()) return;
  const double half_s = 0.5 * sensor.scan_period_s;
  const std::vector<ImuStep> steps =
      imu.steps(scan.stamp_s - half_s, scan.stamp_s + half_s, mounting.turn_to_level());
  if (steps.empty()) return;
  const Reference* reference = reference_of(state);
  const bool is_bias_known = reference != nullptr && reference->inertial;
  const Eigen::Vector3d force_mps2 = mean_specific_force_mps2(steps);
  if (!is_bias_known && !is_gravity(force_mps2)) {
    return inertial_check.complain_about_force(force_mps2);
  }
  scan.turning.emplace(
      steps, half_s,
      is_bias_known ? reference->inertial->gyroscope_bias_rad_per_s : Eigen::Vector3d::Zero());
  scan.turning->apply(scan.features);
  scan.specific_force_mps2 = force_mps2;
}

/// Applies the result of loop closing that is due with this scan.
void Slam::Implementation::collect_loops(Notes& notes) {
  if (!loop_closing) return;
  if (const std::optional<LoopResult> found = loop_closing->collect()) {
    apply(*found);
    notes.report.loop = found->report;
  }
  notes.report.times.loop_closing_s = notes.stopwatch.lap_s();
}

/// Moves map and path with their keyframes. The odometry's frame and the velocity do not change, so
/// tracking continues in the corrected map.
void Slam::Implementation::apply(const LoopResult& found) {
  path.join(found.submap_of_segment);
  if (found.gravity_contradicts) inertial_check.contradict_gravity();
  Reference* reference = reference_of(state);
  if (found.drift && reference != nullptr) apply(*found.drift, reference->state.T_map_sensor);
  if (!found.corrections.empty() && reference != nullptr) {
    mapping.correct(found.corrections);
    path.correct(found.corrections);
    Pose& T_map_reference = reference->state.T_map_sensor;
    T_map_reference = orthonormalized(found.corrections.back() * T_map_reference);
    gravity_window.correct(found.corrections.back());
    if (reference->inertial) turn(*reference->inertial, found.corrections.back().linear());
  }
  mapping.restore_to_window(found.restored);
  // The map cannot begin anew at a keyframe's former pose.
  if (auto* tracking = std::get_if<Tracking>(&state)) tracking->first_keyframe.reset();
  if (auto* lost = std::get_if<Lost>(&state)) lost->last.first_keyframe.reset();
}

/// Reduces the drift of the present pose and of those on segments that were joined. To be called
/// before poses are corrected.
void Slam::Implementation::apply(const LoopedDrift& found, const Pose& T_map_reference) {
  const Pose motion = found.T_map_last.inverse() * T_map_reference;
  const bool is_path_known = found.last_segment == path.last_segment();
  drift.set(improved(drift.state(), found.last, motion, is_path_known));
  for (const LoopedDrift::OfSegment& of : found.segments) {
    path.improve(of.segment, mounting.of_sensor(of.T_map_node), mounting.of_sensor(of.unmeasured));
  }
}

Slam::Slam(const SensorModel& sensor) : Slam(sensor, SlamOptions{}) {}
Slam::Slam(const SensorModel& sensor, const SlamOptions& options)
    : implementation_(std::make_unique<Implementation>(sensor, options, nullptr, std::nullopt)) {}
Slam::Slam(const SensorModel& sensor, const SlamOptions& options, const SavedMap& map,
           const std::optional<Pose>& T_map_level_start)
    : implementation_(std::make_unique<Implementation>(sensor, options, &map, T_map_level_start)) {}
Slam::~Slam() = default;
Slam::Slam(Slam&&) noexcept = default;
Slam& Slam::operator=(Slam&&) noexcept = default;

void Slam::add_imu(const std::vector<ImuSample>& samples) { implementation_->imu.add(samples); }

const std::string& Slam::imu_complaint() const {
  return implementation_->inertial_check.complaint();
}

ScanReport Slam::process(const OrganizedCloud& cloud, double stamp_s, ScanTrace* trace) {
  check(cloud, stamp_s, implementation_->sensor);
  const ThreadLimit limit(implementation_->options.threads);
  if (trace != nullptr) *trace = {};
  const std::optional<OrganizedCloud> sound = without_unsound(cloud);
  return implementation_->process(sound ? *sound : cloud, stamp_s, trace);
}

std::vector<LoopReport> Slam::finish() {
  const ThreadLimit limit(implementation_->options.threads);
  std::vector<LoopReport> reports;
  if (!implementation_->loop_closing) return reports;
  while (const auto found = implementation_->loop_closing->finish()) {
    implementation_->apply(*found);
    reports.push_back(found->report);
  }
  return reports;
}

}  // namespace hqslam::slam
