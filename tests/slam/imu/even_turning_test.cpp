#include "imu/even_turning.h"

#include "testing.h"

using namespace hqslam::slam;

namespace {

constexpr double kHalf_s = 0.05;
const Eigen::Vector3d kBias(0.01, -0.02, 0.03);

/// How the sensor is turned against the stamp: by a rate that grows, about an axis that stays, for
/// which the turn is known in closed form.
const Eigen::Vector3d kAxis = Eigen::Vector3d(1, -2, 3).normalized();
double angle_rad(double time_s) { return 2.0 * time_s + 15.0 * time_s * time_s; }
double rate_rad_per_s(double time_s) { return 2.0 + 30.0 * time_s; }

std::vector<ImuStep> measured(double growing) {
  std::vector<ImuStep> steps;
  for (int k = 0; k < 100; ++k) {
    const double time_s = -kHalf_s + 0.001 * (k + 0.5);
    const double rate = growing * rate_rad_per_s(time_s) + (1.0 - growing) * 2.0;
    steps.push_back({0.001, rate * kAxis + kBias, Eigen::Vector3d::Zero()});
  }
  return steps;
}

}  // namespace

TEST_CASE("points of a sensor whose turn speeds up are put where an even turn would see them") {
  const EvenTurning turning(measured(1.0), kHalf_s, kBias);
  // The mean over the scan is the rate in its middle.
  CHECK(turning.mean_rate_rad_per_s().isApprox(2.0 * kAxis, 1e-9));
  const Eigen::Vector3d place_m(7.0, -3.0, 1.5);  // at the stamp
  Features features;
  for (int i = 0; i <= 20; ++i) {
    const double time_s = -kHalf_s + 0.005 * i;
    const Eigen::AngleAxisd since_stamp(angle_rad(time_s), kAxis);
    FeaturePoint point;
    point.time_offset_s = static_cast<float>(time_s);
    point.point_m = (since_stamp.inverse() * place_m).cast<float>();
    point.slope = (since_stamp.inverse() * Eigen::Vector3d::UnitX()).cast<float>();
    features.ground.push_back(point);
    features.sharp_edges.push_back(point);
  }
  turning.apply(features);
  for (const auto* points : {&features.ground, &features.sharp_edges}) {
    for (const FeaturePoint& point : *points) {
      const Eigen::AngleAxisd even(2.0 * static_cast<double>(point.time_offset_s), kAxis);
      CHECK((even * point.point_m.cast<double>() - place_m).norm() < 2e-4);
      CHECK((even * point.slope.cast<double>() - Eigen::Vector3d::UnitX()).norm() < 1e-4);
    }
  }
}

TEST_CASE("points of a sensor that turns evenly stay, and so do those captured at once") {
  const EvenTurning turning(measured(0.0), kHalf_s, kBias);
  Features features;
  for (const float time_s : {-0.05F, -0.021F, 0.0F, 0.033F, 0.05F, 0.2F}) {
    features.edges.push_back({{1, 2, 3}, time_s, 0, {0, 1, 0}});
  }
  turning.apply(features);
  for (const FeaturePoint& point : features.edges) {
    CHECK((point.point_m - Eigen::Vector3f(1, 2, 3)).norm() < 1e-5F);
  }
  Features at_once;
  at_once.edges.push_back({{1, 2, 3}, 0.0F, 0, {0, 1, 0}});
  EvenTurning(measured(1.0), kHalf_s, kBias).apply(at_once);
  CHECK((at_once.edges[0].point_m - Eigen::Vector3f(1, 2, 3)).norm() < 1e-4F);
}
