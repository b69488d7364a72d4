#include "loops/loop_closing.h"

#include "slam/imu/accelerometer.h"
#include "slam/poses.h"
#include "slam/village.h"

using namespace hqslam::slam;

namespace {

/// The estimated path of a drive, keyframe by keyframe, with the results of loop closing.
struct DrivenCircuit {
  std::vector<Pose> T_map_sensor;
  std::vector<slam::LoopReport> reports;
  std::vector<Eigen::Vector3f> map_points_m;
  std::size_t loops = 0;  ///< that became edges of the pose graph

  int count(LoopStatus status) const {
    return static_cast<int>(std::ranges::count(reports, status, &slam::LoopReport::status));
  }
};

struct Estimate {
  Pose error_per_step = Pose::Identity();
  Status status = Status::kOk;
  bool closes_loops = true;
  Pose error_once = Pose::Identity();  ///< of the step in the middle of the path
  /// The keyframe from which on gravity is measured.
  std::optional<std::size_t> gravity_from = std::nullopt;
};

slam::FeltGravity felt_gravity(std::size_t keyframe, const Pose& T_level_sensor) {
  slam::FeltGravity felt;
  // So slowly that gravity may have changed by the errors of these paths between two keyframes.
  felt.stamp_s = 50.0 * static_cast<double>(keyframe);
  felt.gravity_mps2 = T_level_sensor.linear().transpose() * test::kGravity;
  felt.of_bias.setIdentity();
  felt.scan = keyframe;
  return felt;
}

slam::MappingOptions short_window() { return {.recent_path_m = 30.0}; }

/// Drives a circuit with an odometry that adds an error to every step; the map is built from that.
DrivenCircuit drive(const test::Circuit& circuit, const Estimate& estimate) {
  const SensorModel sensor = test::small_sensor(16, 256);
  slam::Mapping mapping(short_window());
  slam::LoopClosing loop_closing(short_window(), estimate.closes_loops);
  double since_view_m = 0.0;
  DrivenCircuit driven;
  const std::vector<Pose>& truth = circuit.T_village_sensor;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    Pose T_map_sensor = i == 0 ? Pose::Identity()
                               : driven.T_map_sensor.back() * truth[i - 1].inverse() * truth[i] *
                                     estimate.error_per_step;
    if (i == truth.size() / 2) T_map_sensor = T_map_sensor * estimate.error_once;
    const OrganizedCloud cloud = circuit.village.scan(sensor, truth[i]);
    const slam::MapFeatures features = test::features_of(cloud, sensor);
    const slam::ScanMotion standing;
    slam::LoopKeyframe keyframe{T_map_sensor, estimate.status, i, i == 0, {}, std::nullopt};
    if (i > 0) since_view_m += (truth[i].translation() - truth[i - 1].translation()).norm();
    if (i == 0 || since_view_m >= 4.0) {
      keyframe.view = {cloud, features, standing, mapping.slide_window()};
      since_view_m = 0.0;
      if (i >= estimate.gravity_from.value_or(truth.size())) {
        keyframe.gravity = {felt_gravity(i, truth[i])};
      }
    }
    mapping.insert(features, T_map_sensor, standing);
    driven.T_map_sensor.push_back(T_map_sensor);
    std::vector<slam::LoopKeyframe> keyframes;
    keyframes.push_back(std::move(keyframe));
    const slam::LoopResult result = loop_closing.process(std::move(keyframes));
    driven.reports.push_back(result.report);
    if (!result.corrections.empty()) mapping.correct(result.corrections);
    mapping.restore_to_window(result.restored);
    if (result.corrections.empty()) continue;
    for (std::size_t k = 0; k <= i; ++k) {
      driven.T_map_sensor[k] = result.corrections[k] * driven.T_map_sensor[k];
    }
  }
  slam::FeatureMaps map = loop_closing.graph().submaps().front();
  map.insert(slam::FeatureMaps(mapping.map()).take_all());
  driven.map_points_m = map.planes.points_m();
  driven.loops = loop_closing.graph().poses().loops.size();
  return driven;
}

}  // namespace

TEST_CASE("a path that drifts by metres is closed, and path and map become right") {
  const test::Circuit circuit = test::circuit();
  const Pose error = pose_from_xyz_rpy({0.0, 0.0, 0.004}, 0.0, 0.0, 0.0003);
  const DrivenCircuit open = drive(circuit, {error, Status::kOk, false});
  const DrivenCircuit closed = drive(circuit, {error, Status::kOk, true});
  CHECK(test::worst_error_m(open.T_map_sensor, circuit.T_village_sensor) > 2.5);
  CHECK(closed.count(LoopStatus::kClosed) >= 1);
  CHECK(test::worst_error_m(closed.T_map_sensor, circuit.T_village_sensor) < 1.0);
  // The second pass coincides with the first: fewer voxels are taken.
  CHECK(20 * closed.map_points_m.size() < 19 * open.map_points_m.size());
  // The path ends where it was before: both passes are at one place now.
  CHECK(test::closing_error_m(open.T_map_sensor, circuit.T_village_sensor) > 2.0);
  CHECK(test::closing_error_m(closed.T_map_sensor, circuit.T_village_sensor) < 0.15);
  // Drift after that is noticed, though the map of the place is in the window again.
  CHECK(closed.count(LoopStatus::kAgrees) >= 1);
  CHECK(closed.count(LoopStatus::kImplausible) == 0);
  CHECK(drive(circuit, {error, Status::kOk, true}).map_points_m == closed.map_points_m);
}

TEST_CASE("a path without drift is left exactly as it is where it meets itself") {
  const test::Circuit circuit = test::circuit();
  const DrivenCircuit without = drive(circuit, {Pose::Identity(), Status::kOk, false});
  const DrivenCircuit with = drive(circuit, {Pose::Identity(), Status::kOk, true});
  CHECK(with.count(LoopStatus::kAgrees) >= 2);
  CHECK(with.count(LoopStatus::kClosed) == 0);
  CHECK(test::are_same(with.T_map_sensor, without.T_map_sensor));
}

TEST_CASE("a place identical to one passed before is not taken for it") {
  // Two stretches of 50 m with the same houses, 60 m apart on one street. The path begins before
  // the second and comes to the first at the end, with a plausible drift of more than 60 m.
  test::Circuit circuit;
  circuit.village.add_street(14.0, 0.0, 50.0, 21);
  circuit.village.add_street(74.0, 0.0, 50.0, 21);
  circuit.village.add_street(14.0, 60.0, 110.0, 22);
  circuit.village.add_street(0.0, 14.0, 32.0, 23, test::Village::Along::kY);
  circuit.village.add_street(140.0, 14.0, 32.0, 24, test::Village::Along::kY);
  circuit.T_village_sensor =
      test::path_through({{72, 0}, {140, 0}, {140, 60}, {0, 60}, {0, 0}, {62, 0}}, 1.5);
  const DrivenCircuit without = drive(circuit, {Pose::Identity(), Status::kDegenerate, false});
  const DrivenCircuit with = drive(circuit, {Pose::Identity(), Status::kDegenerate, true});
  CHECK(with.count(LoopStatus::kAwaitsOthers) >= 2);  // it is similar
  CHECK(with.count(LoopStatus::kClosed) == 0);
  CHECK(with.map_points_m == without.map_points_m);
}

TEST_CASE("loops that would bend the path more than it bears leave nothing behind") {
  // Around a small block and on, with an error of 4 m in one step of the odometry: each of
  // the few edges of the path would be strained by decimetres.
  test::Circuit circuit;
  circuit.village.add_street(-4.0, 0.0, 40.0, 11);
  circuit.village.add_street(-4.0, 24.0, 40.0, 12);
  circuit.T_village_sensor =
      test::path_through({{0, 0}, {24, 0}, {24, 24}, {0, 24}, {0, 0}, {24, 0}, {24, 24}}, 1.0);
  const Pose jump = pose_from_xyz_rpy({0.0, 4.0, 0.0}, 0.0, 0.0, 0.0);
  const DrivenCircuit without = drive(circuit, {Pose::Identity(), Status::kOk, false, jump});
  const DrivenCircuit with = drive(circuit, {Pose::Identity(), Status::kOk, true, jump});
  CHECK(with.count(LoopStatus::kImplausible) == 1);
  CHECK(with.count(LoopStatus::kClosed) == 0);
  CHECK(with.loops == 0);
  CHECK(with.map_points_m == without.map_points_m);
}

TEST_CASE("points restored to a levelled path move with it") {
  const test::Circuit circuit = test::circuit();
  const std::vector<Pose>& truth = circuit.T_village_sensor;
  const SensorModel sensor = test::small_sensor(16, 256);
  slam::Mapping mapping(short_window());
  slam::LoopClosing loop_closing(short_window(), true);
  std::vector<slam::LoopKeyframe> keyframes;
  std::vector<Pose> T_map_sensor;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    T_map_sensor.push_back(truth.front().inverse() * truth[i]);
    const OrganizedCloud cloud = circuit.village.scan(sensor, truth[i]);
    const slam::MapFeatures features = test::features_of(cloud, sensor);
    keyframes.push_back({T_map_sensor.back(), Status::kOk, i, i == 0, {}, std::nullopt});
    if (i % 3 == 0) {  // every 4.5 m
      keyframes.back().view = {cloud, features, {}, mapping.slide_window()};
      const Pose leans = exponential({{0, 0, 0}, {2e-4 * static_cast<double>(i), 0, 0}});
      if (i > 0) keyframes.back().gravity = {felt_gravity(i, leans * T_map_sensor.back())};
    }
    mapping.insert(features, T_map_sensor.back(), {});
  }
  std::vector<slam::LoopKeyframe> late = keyframes;
  const slam::LoopResult result = loop_closing.process(std::move(keyframes));
  REQUIRE(result.report.status == LoopStatus::kAgrees);
  REQUIRE_FALSE(result.corrections.empty());
  REQUIRE(result.restored.planes.size() > 1000);
  CHECK(result.report.correction_m > 0.0);
  for (const slam::MapPoint& point : result.restored.planes) {
    const Pose T_village_map =
        truth[point.keyframe] *
        (result.corrections[point.keyframe] * T_map_sensor[point.keyframe]).inverse();
    CHECK((T_village_map * point.mean_m.cast<double>()).z() > -0.05);  // not under the ground
  }
  // Gravity counts at the node where it was measured, also where it arrives with a later one.
  std::vector<slam::FeltGravity> gravity;
  slam::LoopKeyframe* last = nullptr;
  for (slam::LoopKeyframe& keyframe : late) {
    for (const slam::FeltGravity& felt : keyframe.gravity) gravity.push_back(felt);
    keyframe.gravity.clear();
    if (keyframe.view) last = &keyframe;
  }
  last->gravity = gravity;
  slam::LoopClosing with_late(short_window(), true);
  const std::vector<Pose> corrections = with_late.process(std::move(late)).corrections;
  REQUIRE(corrections.size() == result.corrections.size());
  CHECK(corrections.back().matrix() == result.corrections.back().matrix());
}

TEST_CASE("loops that wait are not forgotten when the path is levelled meanwhile") {
  const Pose leans_more = pose_from_xyz_rpy({0.0, 0.0, 0.0}, 0.004, 0.0, 0.0002);
  const DrivenCircuit driven =
      drive(test::circuit(), {.error_per_step = leans_more, .gravity_from = 1});
  CHECK(driven.count(LoopStatus::kImplausible) == 0);
  CHECK(driven.count(LoopStatus::kClosed) >= 1);
}
