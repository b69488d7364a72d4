#include "front_end/odometry.h"

#include "slam/village.h"

using slam::Status;

namespace {

const SensorModel kFineSensor = small_sensor(32, 1024);
const Pose kFirst = yard_pose(0, 0, 0.2);

slam::Features seen_from(const Pose& T_yard_sensor) {
  return scan_features(Yard().scan(kFineSensor, T_yard_sensor), kFineSensor);
}

/// Between two scans that are a step apart, each with what change(features) leaves of it.
slam::OdometryResult motion_found(const Pose& step, const auto& change) {
  slam::Features first = seen_from(kFirst);
  slam::Features second = seen_from(kFirst * step);
  change(first);
  change(second);
  return slam::scan_to_scan({first, {}}, second, {Pose::Identity(), 0.1});
}

}  // namespace

TEST_CASE("the motion between two scans is found without a prediction, or by edges alone") {
  for (const bool has_ground : {true, false}) {
    CAPTURE(has_ground);
    const Pose step = pose_from_xyz_rpy({has_ground ? 0.5 : 0.3, 0.05, 0.0}, 0.0, 0.0, 0.03);
    const auto result = motion_found(step, [&](slam::Features& features) {
      if (has_ground) return;
      features.ground.clear();
      features.flat_points.clear();
    });
    CHECK((result.planar_correspondences > 0) == has_ground);
    CHECK(result.status != Status::kTooFewFeatures);
    if (has_ground) CHECK(result.status == Status::kOk);
    CHECK((result.T_reference_sensor.translation() - step.translation()).norm() < 0.05);
    CHECK(rotation_angle_rad(result.T_reference_sensor.inverse() * step) < 0.005);
  }
}

TEST_CASE("the search covers all of the reference, however few features the scan has") {
  const slam::Features scan = seen_from(kFirst);
  slam::Features sparse = scan;  // its last edges: LeGO-LOAM would search the first 12 points only
  sparse.sharp_edges.assign(scan.sharp_edges.end() - 12, scan.sharp_edges.end());
  const auto result = slam::scan_to_scan({scan, {}}, sparse, {Pose::Identity(), 0.1});
  CHECK(result.edge_correspondences >= 10);
}

TEST_CASE("ground alone gives height, roll and pitch, with status degenerate") {
  const Pose step = pose_from_xyz_rpy({0.0, 0.0, 0.1}, 0.01, -0.02, 0.0);
  const auto result = motion_found(step, [](slam::Features& features) {
    features.edges.clear();
    features.sharp_edges.clear();
  });
  CHECK(result.status == Status::kTooFewFeatures);
  CHECK(result.T_reference_sensor.translation().z() == doctest::Approx(0.1).epsilon(0.05));
  CHECK(rotation_angle_rad(result.T_reference_sensor.inverse() * step) < 0.002);
}

TEST_CASE("too few features leave the prediction and say so") {
  const slam::Features features = seen_from(kFirst);
  const Pose predicted = pose_from_xyz_rpy({1, 2, 3}, 0, 0, 0.5);
  const slam::OdometryTarget reference(features, {});
  const slam::OdometryTarget empty(slam::Features{}, {});
  for (const auto& result : {slam::scan_to_scan(empty, features, {predicted, 0.1}),
                             slam::scan_to_scan(reference, slam::Features{}, {predicted, 0.1})}) {
    CHECK(result.status == Status::kTooFewFeatures);
    CHECK(result.T_reference_sensor.isApprox(predicted));
  }
}
