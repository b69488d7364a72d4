#include "hqslam/slam/lego_loam_as_published.h"

#include <doctest/doctest.h>

#include <cmath>

#include "hqslam/evaluation/trajectory_error.h"
#include "hqslam/slam/slam.h"
#include "lego_loam_as_published/published_features.h"
#include "lego_loam_as_published/published_odometry.h"
#include "lego_loam_as_published/published_step.h"
#include "lego_loam_as_published/segmented_scan.h"
#include "slam/poses.h"
#include "slam/village.h"

using namespace hqslam;
using namespace hqslam::slam::as_published;
using slam::FeaturePoint;
using slam::LegoLoamAsPublished;

namespace {

constexpr double kPublishedPeriod_s = 0.1;
constexpr float kSweepEnd_s = 0.05F;

/// Rings of 120 points on the ground, 1.8 m below, two metres apart, `z_m` higher.
std::vector<FeaturePoint> rings(int rows, int points, float z_m) {
  std::vector<FeaturePoint> result;
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < points; ++i) {
      const auto azimuth_rad = static_cast<float>(2.0 * M_PI * i / points);
      const float radius_m = 6.0F + 2.0F * static_cast<float>(row);
      result.push_back(
          {{radius_m * std::cos(azimuth_rad), radius_m * std::sin(azimuth_rad), z_m - 1.8F},
           kSweepEnd_s,
           row});
    }
  }
  return result;
}

/// Twelve upright posts all around, seen in each of `rows` rows, moved along x.
std::vector<FeaturePoint> posts(int rows, float x_m) {
  std::vector<FeaturePoint> result;
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i < 12; ++i) {
      const auto azimuth_rad = static_cast<float>(2.0 * M_PI * i / 12.0);
      result.push_back({{12.0F * std::cos(azimuth_rad) + x_m, 12.0F * std::sin(azimuth_rad),
                         0.5F * static_cast<float>(row)},
                        kSweepEnd_s,
                        row});
    }
  }
  return result;
}

PublishedFeatures first_scan() { return {{}, posts(2, 0.0F), {}, rings(3, 120, 0.0F)}; }

Parameters motion_to(const PublishedFeatures& features) {
  PublishedOdometry odometry(kPublishedPeriod_s);
  odometry.add(first_scan());
  odometry.add(features);
  return odometry.motion();
}

/// Along a street of the village, at 3 m/s.
struct PublishedDrive {
  test::Circuit circuit = test::circuit();
  Trajectory truth;
  explicit PublishedDrive(int scans) {
    for (int i = 0; i < scans; ++i) {
      truth.push_back(
          {kPublishedPeriod_s * i, pose_from_xyz_rpy({8.0 + 0.3 * i, 0.0, 1.7}, 0.0, 0.0, 0.0)});
    }
  }
  template <typename System>
  Trajectory driven(System system, const SensorModel& sensor) const {
    for (const StampedPose& pose : truth) {
      system.process(circuit.village.scan(sensor, pose.T_map_sensor), pose.stamp_s);
    }
    return system.trajectory();
  }
};

double ape_m(const Trajectory& estimate, const Trajectory& truth) {
  return absolute_pose_error(estimate, truth, Alignment::kFirstPose).translation_statistics.rmse;
}

}  // namespace

// Every step takes 5 % of what is left: 0.95^25 = 0.28 of it stays.
TEST_CASE("as published, 25 steps of five percent leave 28 percent of the motion") {
  PublishedFeatures upsampled;
  upsampled.flat = rings(2, 20, 0.1F);
  const Parameters motion = motion_to(upsampled);
  CHECK(motion(5) == doctest::Approx(-0.1 * (1.0 - std::pow(0.95, 25))).epsilon(1e-3));
  CHECK(motion.head<5>().norm() < 1e-4);
}

TEST_CASE("as published, the search upwards ends at as many points as the scan has features") {
  PublishedFeatures few;
  few.sharp = posts(1, 0.2F);  // twelve: the last scan's second row begins at its thirteenth point
  CHECK(motion_to(few).norm() == 0.0);
  PublishedFeatures many;
  many.sharp = posts(2, 0.2F);
  CHECK(motion_to(many)(3) == doctest::Approx(-0.2 * (1.0 - std::pow(0.95, 25))).epsilon(1e-2));
}

TEST_CASE("as published, the row of a cluster's first point does not count") {
  const SensorModel sensor = sensor_preset("os1-16");
  RangeImage image(16, sensor.columns);
  // From below: one point, two, two. Five points over three rows.
  for (const auto& [row, column] : {std::pair{6, 100}, {5, 100}, {5, 101}, {4, 100}, {4, 101}}) {
    image.at(row, column) = 5.0F;
  }
  const auto kept = [&] {
    return ImageProjection(sensor)
        .segment(unproject(image, sensor, CaptureTime::kRolling))
        .points.size();
  };
  CHECK(kept() == 0);
  image.at(6, 101) = 5.0F;
  CHECK(kept() == 6);
}

TEST_CASE("as published, of the ground every fifth column is kept and rows rise") {
  const SensorModel sensor = sensor_preset("os1-16");
  const SegmentedScan scan = ImageProjection(sensor).segment(
      test::Village().scan(sensor, pose_from_xyz_rpy({0, 0, 1.7}, 0, 0, 0)));
  REQUIRE_FALSE(scan.points.empty());
  REQUIRE(scan.first.size() == 16);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const int column = scan.points[i].column;
    CHECK(scan.points[i].ground);
    CHECK((column % 5 == 0 || column <= 5 || column >= sensor.columns - 5));
    if (i > 0) CHECK(scan.points[i].point.row >= scan.points[i - 1].point.row);
  }
  CHECK(scan.points.front().point.row == 0);
}

TEST_CASE("as published, steps take only the directions whose eigenvalues are large at first") {
  PublishedSteps<3> steps(1.0, 10.0);
  for (int i = 0; i < 20; ++i) steps.add({1.0, 0.0, 0.0}, 0.5);
  steps.add({0.0, 1.0, 0.0}, 0.5);
  CHECK(steps.take().isApprox(Eigen::Vector3d(-0.5, 0.0, 0.0), 1e-9));
  for (int i = 0; i < 20; ++i) steps.add({0.0, 1.0, 0.0}, 0.5);  // too late
  CHECK(steps.take().norm() < 1e-9);
}

TEST_CASE("the derivatives of a rotation are its differences") {
  Parameters p;
  p << 0.1, -0.2, 0.7, 0.0, 0.0, 0.0;
  const auto derivatives = rotation_derivatives(p);
  for (int i = 0; i < 3; ++i) {
    Parameters later = p;
    later(i) += 1e-6;
    const Eigen::Matrix3d difference =
        (slam::as_published::pose_of(later).linear() - slam::as_published::pose_of(p).linear()) /
        1e-6;
    CHECK((difference - derivatives[i]).norm() < 1e-5);
  }
  CHECK((slam::as_published::parameters_of(slam::as_published::pose_of(p)) - p).norm() < 1e-12);
}

TEST_CASE("LeGO-LOAM as published follows a slow drive, not as closely as Slam does") {
  const PublishedDrive drive(40);
  const SensorModel sensor = sensor_preset("os1-16");
  const Trajectory published = drive.driven(LegoLoamAsPublished(sensor), sensor);
  REQUIRE(published.size() == drive.truth.size());
  const double published_m = ape_m(published, drive.truth);
  MESSAGE("as published " << published_m << " m, Slam "
                          << ape_m(drive.driven(slam::Slam(sensor), sensor), drive.truth) << " m");
  CHECK(published_m < 1.0);
  CHECK(published_m > ape_m(drive.driven(slam::Slam(sensor), sensor), drive.truth));
}

TEST_CASE("as published, too, the same scans give the same poses, and nothing seen is survived") {
  const PublishedDrive drive(6);
  const SensorModel sensor = sensor_preset("os1-16");
  const Trajectory first = drive.driven(LegoLoamAsPublished(sensor), sensor);
  const Trajectory second = drive.driven(LegoLoamAsPublished(sensor), sensor);
  CHECK(test::are_same(first, second));
  LegoLoamAsPublished blind(sensor);
  for (int i = 0; i < 8; ++i) {
    const Pose pose = blind.process(OrganizedCloud(16, sensor.columns), kPublishedPeriod_s * i);
    CHECK(pose.matrix().isIdentity(1e-12));
  }
}
