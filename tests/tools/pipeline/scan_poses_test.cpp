#include "hqslam/pipeline/scan_poses.h"

#include "testing.h"

namespace hqslam::pipeline {
namespace {

constexpr double kPeriod_s = 0.1;
constexpr double kAhead_m_per_s = 20.0;

Pose at(double time_s, double noise_m = 0.0) {
  return Pose(Eigen::Translation3d(kAhead_m_per_s * time_s + noise_m, 0.0, 0.0));
}

/// Of a sensor that drives straight on, one pose every so often.
ScanPoses poses_every(double step_s, double noise_m = 0.0) {
  ScanPoses poses;
  for (int i = 0; i * step_s < 3.0; ++i) {
    poses.trajectory.push_back({i * step_s, at(i * step_s, i % 2 == 0 ? noise_m : -noise_m)});
  }
  return poses;
}

/// How far a path is from where the sensor was during a scan.
double error_m(const ScanPoses& poses, double stamp_s) {
  const auto path = poses.path_of(0, stamp_s, kPeriod_s).value();
  double worst_m = 0.0;
  for (const double offset_s : {-0.05, -0.02, 0.0, 0.02, 0.05}) {
    const Eigen::Vector3d off_m =
        path.at(offset_s).translation() - at(stamp_s + offset_s).translation();
    worst_m = std::max(worst_m, off_m.norm());
  }
  return worst_m;
}

}  // namespace

TEST_CASE("a scan is where the sensor was at its stamp, whatever the rate of the poses") {
  for (const double step_s : {0.1, 1.0 / 30.3, 0.02, 0.001}) {
    CAPTURE(step_s);
    for (const double stamp_s : {0.0, 1.0, 1.017, 2.0}) {
      const double nearest_s = step_s * std::round(stamp_s / step_s);
      if (std::abs(stamp_s - nearest_s) < 0.02) CHECK(error_m(poses_every(step_s), stamp_s) < 1e-9);
    }
  }
  CHECK_FALSE(poses_every(0.1).path_of(0, 1.03, kPeriod_s));
  CHECK_FALSE(poses_every(0.1).path_of(0, 9.0, kPeriod_s));
}

TEST_CASE("what poses err by from one to the next is not extrapolated over a scan") {
  for (const double step_s : {0.02, 0.005, 0.001}) {
    CAPTURE(step_s);
    CHECK(error_m(poses_every(step_s, 0.003), 1.0) < 0.012);
  }
}

}  // namespace hqslam::pipeline
