#include "front_end/odometry.h"

#include <doctest/doctest.h>

#include "slam/yard.h"

using namespace hqslam;
using slam::Status;

namespace {

slam::Features scan_features(const SensorModel& sensor, const OrganizedCloud& cloud) {
  slam::Segmenter segmenter(sensor, {}, {});
  return slam::extract_features(cloud, segmenter.segment(cloud), {});
}

}  // namespace

TEST_CASE("the motion between two scans is found without a prediction") {
  const SensorModel sensor = test::small_sensor(32, 1024);
  const test::Yard yard;
  const Pose step = pose_from_xyz_rpy({0.5, 0.05, 0.0}, 0.0, 0.0, 0.03);
  const Pose first = test::yard_pose(0, 0, 0.2);
  const auto result = slam::scan_to_scan({scan_features(sensor, yard.scan(sensor, first)), {}},
                                         scan_features(sensor, yard.scan(sensor, first * step)),
                                         {Pose::Identity(), 0.1}, {});
  CHECK(result.status == Status::kOk);
  CHECK((result.T_reference_sensor.translation() - step.translation()).norm() < 0.05);
  CHECK(rotation_angle_rad(result.T_reference_sensor.inverse() * step) < 0.005);
}

TEST_CASE("the search covers all of the reference, however few features the scan has") {
  const SensorModel sensor = test::small_sensor(32, 1024);
  const test::Yard yard;
  const Pose first = test::yard_pose(0, 0, 0.2);
  const slam::Features scan = scan_features(sensor, yard.scan(sensor, first));
  slam::Features sparse = scan;  // its last edges: LeGO-LOAM would search the first 12 points only
  sparse.sharp_edges.assign(scan.sharp_edges.end() - 12, scan.sharp_edges.end());
  const auto result = slam::scan_to_scan({scan, {}}, sparse, {Pose::Identity(), 0.1}, {});
  CHECK(result.edge_correspondences >= 10);
}

TEST_CASE("without any ground, edges alone find the motion") {
  const SensorModel sensor = test::small_sensor(32, 1024);
  const test::Yard yard;
  const Pose step = pose_from_xyz_rpy({0.3, 0.05, 0.0}, 0.0, 0.0, 0.03);
  const Pose first = test::yard_pose(0, 0, 0.2);
  const auto edges_alone = [&](const Pose& T_yard_sensor) {
    slam::Features features = scan_features(sensor, yard.scan(sensor, T_yard_sensor));
    features.ground.clear();
    features.flat_points.clear();
    return features;
  };
  const auto result = slam::scan_to_scan({edges_alone(first), {}}, edges_alone(first * step),
                                         {Pose::Identity(), 0.1}, {});
  CHECK(result.planar_correspondences == 0);
  CHECK(result.status != Status::kTooFewFeatures);
  CHECK((result.T_reference_sensor.translation() - step.translation()).norm() < 0.05);
  CHECK(rotation_angle_rad(result.T_reference_sensor.inverse() * step) < 0.005);
}

TEST_CASE("ground alone tells height, roll and pitch, and says that it is not all") {
  const SensorModel sensor = test::small_sensor(32, 1024);
  const test::Yard yard;
  const auto ground_alone = [&](const Pose& T_yard_sensor) {
    slam::Features features = scan_features(sensor, yard.scan(sensor, T_yard_sensor));
    features.edges.clear();
    features.sharp_edges.clear();
    return features;
  };
  const Pose first = test::yard_pose(0, 0, 0.2);
  const Pose step = pose_from_xyz_rpy({0.0, 0.0, 0.1}, 0.01, -0.02, 0.0);
  const auto result = slam::scan_to_scan({ground_alone(first), {}}, ground_alone(first * step),
                                         {Pose::Identity(), 0.1}, {});
  CHECK(result.status == Status::kTooFewFeatures);
  CHECK(result.T_reference_sensor.translation().z() == doctest::Approx(0.1).epsilon(0.05));
  CHECK(rotation_angle_rad(result.T_reference_sensor.inverse() * step) < 0.002);
}

TEST_CASE("too few features leave the prediction and say so") {
  const SensorModel sensor = test::small_sensor();
  const test::Yard yard;
  const auto features = scan_features(sensor, yard.scan(sensor, test::yard_pose(0, 0, 0)));
  const Pose predicted = pose_from_xyz_rpy({1, 2, 3}, 0, 0, 0.5);
  const slam::OdometryTarget reference(features, {});
  const slam::OdometryTarget empty(slam::Features{}, {});
  for (const auto& result :
       {slam::scan_to_scan(empty, features, {predicted, 0.1}, {}),
        slam::scan_to_scan(reference, slam::Features{}, {predicted, 0.1}, {})}) {
    CHECK(result.status == Status::kTooFewFeatures);
    CHECK(result.T_reference_sensor.isApprox(predicted));
  }
}
