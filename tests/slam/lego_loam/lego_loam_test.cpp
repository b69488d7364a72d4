#include "hqslam/lego_loam/lego_loam.h"

#include "hqslam/evaluation/trajectory_error.h"
#include "slam/yard_drive.h"

using namespace hqslam::lego_loam;

static const SensorModel kSensor = small_sensor(16, 512);

TEST_CASE("LeGO-LOAM follows a drive around a yard") {
  LegoLoam system(kSensor);
  Trajectory truth;
  for (int i = 0; i < 40; ++i) {
    const double stamp_s = i * kDrivePeriod_s;
    truth.push_back({stamp_s, drive_pose(stamp_s)});
    system.process(drive_scan(kSensor, i), stamp_s);
  }
  REQUIRE(system.trajectory().size() == 40);
  const auto error = absolute_pose_error(system.trajectory(), truth, Alignment::kFirstPose);
  CHECK(error.translation_statistics.rmse < 0.1);
  CHECK(system.map_points_m().size() > 1000);
}

TEST_CASE("LeGO-LOAM's trace shows what each stage made of a scan") {
  LegoLoam system(kSensor);
  for (int i = 0; i < 2; ++i) {
    ScanTrace trace;
    const OrganizedCloud scan = drive_scan(kSensor, i);
    const auto report = system.process(scan, i * kDrivePeriod_s, &trace);
    CHECK(report.ground_points == std::ranges::count(trace.label, ScanTrace::kGround));
    CHECK(report.clusters == std::ranges::max(trace.label));
    CHECK(report.edge_features == std::ranges::count(trace.feature, FeatureKind::kSharp));
    CHECK(report.planar_features == std::ranges::count(trace.feature, FeatureKind::kFlat));
    CHECK((i == 0) == trace.T_odom_end.isApprox(Pose::Identity()));
    CHECK(report.keyframe == (i == 1));
  }
}

TEST_CASE("LeGO-LOAM stays where it is while it sees nothing, and takes no harm from garbage") {
  LegoLoam system(kSensor);
  for (int i = 0; i < 8; ++i) {
    OrganizedCloud cloud(kSensor.rows(), kSensor.columns);
    if (i % 2 == 1) {
      std::ranges::fill(cloud.range_m, 5.0F);
      std::ranges::fill(cloud.points_m, i % 4 == 1 ? Eigen::Vector3f(1e30F, 0.0F, 0.0F)
                                                   : Eigen::Vector3f(5.0F, 0.0F, 0.0F));
      cloud.points_m[7].x() = std::numeric_limits<float>::quiet_NaN();
    }
    CHECK(system.process(cloud, i * kDrivePeriod_s).T_map_sensor.matrix().allFinite());
  }
  LegoLoam blind(kSensor);
  for (int i = 0; i < 8; ++i) {
    const OrganizedCloud nothing(kSensor.rows(), kSensor.columns);
    CHECK(blind.process(nothing, i * kDrivePeriod_s).T_map_sensor.isApprox(Pose::Identity()));
  }
}

TEST_CASE("LeGO-LOAM refuses scans of another sensor and stamps that are no times") {
  LegoLoam system(kSensor);
  CHECK(refused_with([&] { system.process(OrganizedCloud(3, 4), 0.0); }, "3x4", "16x512"));
  CHECK(refused_with([&] { system.process(OrganizedCloud(16, 512), NAN); }, "stamp"));
  CHECK_THROWS_AS(LegoLoam{SensorModel()}, Error);
}
