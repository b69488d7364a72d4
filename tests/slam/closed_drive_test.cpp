#include "hqslam/slam/options.h"
#include "hqslam/slam/slam.h"
#include "slam/poses.h"
#include "slam/village.h"
#include "thread_limit.h"

TEST_CASE("a drive that drifts by metres is closed, smoothly, the same whatever the threads") {
  const test::Circuit circuit = test::circuit();
  const SensorModel sensor = test::street_sensor();
  std::vector<OrganizedCloud> scans;
  for (const Pose& T_village_sensor : circuit.T_village_sensor) {
    scans.push_back(circuit.village.scan(sensor, T_village_sensor));
    // Wrongly calibrated it bends straight walls: every metre of path turns the estimate a little.
    constexpr float kBend_per_m = 0.0002F;
    for (std::size_t i = 0; i < scans.back().range_m.size(); ++i) {
      if (scans.back().range_m[i] == 0.0F) continue;
      Eigen::Vector3f& point_m = scans.back().points_m[i];
      point_m.y() += kBend_per_m * point_m.x() * point_m.x();
      scans.back().range_m[i] = point_m.norm();
    }
  }
  slam::SlamOptions options;
  options.mapping.recent_path_m = 50.0;
  std::vector<slam::ScanReport> reports;
  const auto closed_by = [&](int threads) {
    const slam::ThreadLimit limit(threads);
    reports.clear();
    slam::Slam slam(sensor, options);
    for (const OrganizedCloud& scan : scans) {
      reports.push_back(slam.process(scan, 0.1 * static_cast<double>(reports.size())));
    }
    slam.finish();
    return std::pair(test::poses_of(slam.trajectory()), slam.map_points_m());
  };
  const auto with_two = closed_by(2);
  const auto [T_map_sensor, map_points_m] = closed_by(1);

  const auto is_closed = [](const slam::ScanReport& report) {
    return report.loop.status == slam::LoopStatus::kClosed;
  };
  const auto first_closed = std::ranges::find_if(reports, is_closed);
  REQUIRE(first_closed < reports.end() - 1);
  const auto at = static_cast<std::size_t>(first_closed - reports.begin());
  CHECK(reports[at].loop.correction_m > 2.0);
  CHECK(reports[at].loop.older_scan < at / 2);
  CHECK(test::closing_error_m(T_map_sensor, circuit.T_village_sensor) < 0.3);
  const auto variance_m2 = [&](std::size_t i) {
    return reports[i].covariance.topLeftCorner<3, 3>().trace();
  };
  CHECK(variance_m2(at) < 0.5 * variance_m2(at - 1));

  // Tracking continues smoothly, and the odometry is not affected.
  const auto step_m = [&](Pose slam::ScanReport::*T_sensor, std::size_t i) {
    return ((reports[i - 1].*T_sensor).inverse() * (reports[i].*T_sensor)).translation().norm();
  };
  CHECK(step_m(&slam::ScanReport::T_map_sensor, at + 1) == doctest::Approx(1.5).epsilon(0.1));
  CHECK(step_m(&slam::ScanReport::T_odom_sensor, at) == doctest::Approx(1.5).epsilon(0.1));
  CHECK(step_m(&slam::ScanReport::T_odom_sensor, at + 1) == doctest::Approx(1.5).epsilon(0.1));

  CHECK(with_two.second == map_points_m);
  CHECK(test::are_same(with_two.first, T_map_sensor));
}
