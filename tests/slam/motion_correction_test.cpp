#include "hqslam/slam/motion_correction.h"

#include <doctest/doctest.h>

#include <random>

#include "yard.h"

using namespace hqslam;
using slam::FeaturePoint;

TEST_CASE("a point without time offset stays where it is") {
  const slam::SensorMotion motion{pose_from_xyz_rpy({1, 2, 3}, 0.1, 0.2, 0.3), 0.1};
  const auto corrected = slam::motion_corrected({{{4, 5, 6}, 0.0F, 0}}, motion);
  CHECK(corrected[0] == Eigen::Vector3f(4, 5, 6));
}

TEST_CASE("a sensor that moves 1 m forward sees a point of the scan's end 0.5 m nearer") {
  const slam::SensorMotion motion{pose_from_xyz_rpy({1, 0, 0}, 0, 0, 0), 0.1};
  const auto corrected = slam::motion_corrected({{{9.5F, 0, 0}, 0.05F, 0}}, motion);
  CHECK((corrected[0] - Eigen::Vector3f(10, 0, 0)).norm() < 1e-5F);
}

TEST_CASE("correction equals the interpolated pose, for random motions and times") {
  std::mt19937 generator(3);
  const auto random = [&] { return static_cast<double>(generator() % 2001) / 1000.0 - 1.0; };
  for (int trial = 0; trial < 200; ++trial) {
    const Pose step = pose_from_xyz_rpy({random(), random(), random()}, 0.2 * random(),
                                        0.2 * random(), 0.5 * random());
    const FeaturePoint point{Eigen::Vector3d(20 * random(), 20 * random(), random()).cast<float>(),
                             static_cast<float>(0.05 * random()), 0};
    const auto corrected = slam::motion_corrected({point}, {step, 0.1});
    const Pose T = interpolate(Pose::Identity(), step, point.time_offset_s / 0.1);
    CHECK((corrected[0].cast<double>() - T * point.point_m.cast<double>()).norm() < 1e-4);
  }
}

TEST_CASE("a scan from a moving sensor, corrected, is the scan's walls again") {
  const SensorModel sensor = test::small_sensor(8, 360);
  test::Yard yard;
  yard.pillars = false;
  const Pose step = pose_from_xyz_rpy({1.2, 0.1, 0}, 0, 0, 0.12);
  const Pose T_yard_sensor = test::yard_pose(3, -2, 0.4);
  const OrganizedCloud cloud = yard.scan(sensor, T_yard_sensor, &step);
  std::vector<FeaturePoint> points;
  for (std::size_t i = 0; i < cloud.range_m.size(); ++i) {
    if (cloud.range_m[i] > 0.0F) points.push_back({cloud.points_m[i], cloud.time_offset_s[i], 0});
  }
  const auto distance_from_yard = [&](const Eigen::Vector3f& p) {
    const Eigen::Vector3d in_yard = T_yard_sensor * p.cast<double>();
    return std::min({std::abs(in_yard.z()), std::abs(std::abs(in_yard.x()) - yard.half_length_m),
                     std::abs(std::abs(in_yard.y()) - yard.half_width_m)});
  };
  double worst_m = 0.0;
  double worst_raw_m = 0.0;
  for (const auto& p : slam::motion_corrected(points, {step, sensor.scan_period_s})) {
    worst_m = std::max(worst_m, distance_from_yard(p));
  }
  for (const auto& p : points) worst_raw_m = std::max(worst_raw_m, distance_from_yard(p.point_m));
  CHECK(worst_m < 1e-3);
  CHECK(worst_raw_m > 0.5);
}
