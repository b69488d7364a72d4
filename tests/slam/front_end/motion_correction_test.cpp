#include "front_end/motion_correction.h"

#include "slam/steady_drive.h"
#include "slam/yard.h"

using slam::FeaturePoint;

TEST_CASE("a sensor at 10 m/s sees a point of the scan's end 0.5 m nearer, one of its middle not") {
  const auto corrected = slam::motion_corrected({{{9.5F, 0, 0}, 0.05F, 0}, {{4, 5, 6}, 0.0F, 0}},
                                                {{10, 0, 0}, {0, 0, 0}});
  CHECK((corrected[0] - Eigen::Vector3f(10, 0, 0)).norm() < 1e-5F);
  CHECK(corrected[1] == Eigen::Vector3f(4, 5, 6));
}

TEST_CASE("correction is that of a body with a constant twist, for random twists and times") {
  std::mt19937 generator(3);
  const auto random = [&] { return static_cast<double>(generator() % 2001) / 1000.0 - 1.0; };
  for (int trial = 0; trial < 200; ++trial) {
    const test::SteadyDrive drive{Pose::Identity(),
                                  {20 * random(), 5 * random(), 5 * random()},
                                  {2 * random(), 2 * random(), 5 * random() + 1e-3}};
    const FeaturePoint point{Eigen::Vector3d(20 * random(), 20 * random(), random()).cast<float>(),
                             static_cast<float>(0.05 * random()), 0};
    const auto found = slam::motion_corrected({point}, {drive.velocity_mps, drive.turn_rad_per_s});
    const Pose T = drive.at(point.time_offset_s);
    CHECK((found[0].cast<double>() - T * point.point_m.cast<double>()).norm() < 2e-5);
  }
}
