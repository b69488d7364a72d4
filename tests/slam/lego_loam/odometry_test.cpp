#include "odometry.h"

#include "testing.h"

using namespace hqslam::lego_loam;

namespace {

/// Rings of points on the ground, 1.8 m below, two metres apart, `z_m` higher.
Cloud rings(int rows, int points, float z_m) {
  Cloud result;
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < points; ++i) {
      const auto azimuth_rad = static_cast<float>(2.0 * M_PI * i / points);
      const float radius_m = 6.0F + 2.0F * static_cast<float>(row);
      result.push_back(
          point_of({radius_m * std::cos(azimuth_rad), radius_m * std::sin(azimuth_rad), z_m - 1.8F},
                   row, 1.0));
    }
  }
  return result;
}

/// Twelve upright posts all around, seen in each of `rows` rows at one moment, moved along x.
Cloud posts(int rows, double x_m, double moment = 1.0) {
  Cloud result;
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < 12; ++i) {
      const double azimuth_rad = 2.0 * M_PI * i / 12.0;
      const Eigen::Vector3d point_m(12.0 * std::cos(azimuth_rad) + x_m,
                                    12.0 * std::sin(azimuth_rad), 0.5 * row);
      result.push_back(point_of(point_m.cast<float>(), row, moment));
    }
  }
  return result;
}

Features reference() { return {{}, posts(2, 0.0), {}, rings(3, 120, 0.0F), {}, {}}; }

PoseParameters motion_to(const Cloud& sharp, const Cloud& flat) {
  Odometry odometry;
  odometry.add(reference());
  return odometry.add({sharp, {}, flat, {}, {}, {}}).motion;
}

}  // namespace

// The program's 25 steps of 5 % leave 28 % of it.
TEST_CASE("step 1 finds a rise of the ground whole") {
  const PoseParameters motion = motion_to({}, rings(2, 20, 0.1F));
  CHECK(motion.out_of_plane[0] == doctest::Approx(-0.1).epsilon(1e-3));
  CHECK(motion.out_of_plane.tail<2>().norm() < 1e-4);
  CHECK(motion.in_plane.norm() == 0.0);
}

// The program searches only as many of the last points as the scan has features: here none of the
// second row.
TEST_CASE("step 2 finds a motion along the ground whole, from few features, too") {
  const PoseParameters motion = motion_to(posts(1, 0.2), {});
  CHECK(motion.in_plane[0] == doctest::Approx(-0.2).epsilon(1e-3));
  CHECK(motion.out_of_plane.norm() == 0.0);
}

// Matched as LOAM does, with the last posts moved to the end of their sweep by the last estimate,
// an error of it would come back four times as large with each scan.
TEST_CASE("errors do not grow where all edges stand early in the sweep") {
  Odometry odometry;
  for (int scan = 0; scan < 12; ++scan) {
    const double x_m = -0.1 * scan - (scan == 3 ? 0.02 : 0.0);  // one scan is off by 0.02 m
    const Cloud seen = posts(2, x_m, 0.2);
    const auto motion = odometry.add({seen, seen, {}, rings(3, 120, 0.0F), {}, {}}).motion;
    if (scan > 4) CHECK(motion.in_plane[0] == doctest::Approx(0.1).epsilon(1e-2));
  }
}

TEST_CASE("too few features leave the last motion") {
  Odometry odometry;
  odometry.add(reference());
  const OdometryResult result = odometry.add({});
  CHECK(result.has_motion);
  CHECK(result.edges == 0);
  CHECK(result.planes == 0);
  CHECK(pose_of(result.motion).isApprox(Pose::Identity()));
}
