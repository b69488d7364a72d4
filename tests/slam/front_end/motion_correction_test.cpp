#include "front_end/motion_correction.h"

#include "slam/steady_drive.h"
#include "slam/yard.h"

using slam::FeaturePoint;

TEST_CASE("a sensor that brakes is corrected along its path, not along that of its velocity") {
  const slam::ScanMotion braking{{{3, 0, 0}, {0, 0, 1.5}}, {{-4, 0, 0}, {0, 0, -5}}};
  for (const float time_s : {-0.05F, 0.05F}) {
    const double t = time_s;
    const Pose T = exponential({{3 * t - 2 * t * t, 0, 0}, {0, 0, 1.5 * t - 2.5 * t * t}});
    const FeaturePoint point{{8, -6, 1}, time_s, 0};
    const Eigen::Vector3f true_m = (T * point.point_m.cast<double>()).cast<float>();
    CHECK((slam::motion_corrected({point}, braking)[0] - true_m).norm() < 1e-3F);
    CHECK((slam::motion_corrected({point}, {braking.velocity})[0] - true_m).norm() > 0.05F);
  }
}

TEST_CASE("correction is that of a body with a constant twist, for random twists and times") {
  std::mt19937 generator(3);
  const auto random = [&] { return static_cast<double>(generator() % 2001) / 1000.0 - 1.0; };
  for (int trial = 0; trial < 200; ++trial) {
    const SteadyDrive drive{Pose::Identity(),
                            {20 * random(), 5 * random(), 5 * random()},
                            {2 * random(), 2 * random(), 5 * random() + 1e-3}};
    const FeaturePoint point{Eigen::Vector3d(20 * random(), 20 * random(), random()).cast<float>(),
                             static_cast<float>(0.05 * random()), 0};
    const auto found =
        slam::motion_corrected({point}, {{drive.velocity_mps, drive.turn_rad_per_s}});
    const Pose T = drive.at(point.time_offset_s);
    CHECK((found[0].cast<double>() - T * point.point_m.cast<double>()).norm() < 2e-5);
  }
}
