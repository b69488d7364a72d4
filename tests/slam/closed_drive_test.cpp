#include "hqslam/slam/options.h"
#include "hqslam/slam/slam.h"
#include "slam/poses.h"
#include "slam/village.h"
#include "thread_limit.h"

using namespace hqslam;

namespace {

constexpr double kPeriod_s = 0.1;

/// What became of a drive once around a block and on.
struct ClosedDrive {
  std::vector<Pose> T_map_sensor;
  std::vector<slam::ScanReport> reports;
  std::vector<Eigen::Vector3f> map_points_m;
};

}  // namespace

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
  std::vector<ClosedDrive> closed;
  for (const int threads : {1, 2}) {
    const slam::ThreadLimit limit(threads);
    slam::SlamOptions options;
    options.mapping.recent_path_m = 50.0;
    slam::Slam slam(sensor, options);
    std::vector<slam::ScanReport> reports;
    for (const OrganizedCloud& scan : scans) {
      reports.push_back(slam.process(scan, kPeriod_s * static_cast<double>(reports.size())));
    }
    slam.finish();
    closed.push_back({test::poses_of(slam.trajectory()), reports, slam.map_points_m()});
  }

  const std::vector<slam::ScanReport>& reports = closed[0].reports;
  const auto is_closed = [](const slam::ScanReport& report) {
    return report.loop.status == slam::LoopStatus::kClosed;
  };
  const auto first_closed = std::ranges::find_if(reports, is_closed);
  REQUIRE(first_closed < reports.end() - 1);
  const auto at = static_cast<std::size_t>(first_closed - reports.begin());
  CHECK(reports[at].loop.correction_m > 2.0);
  CHECK(reports[at].loop.older_scan < at / 2);
  CHECK(test::closing_error_m(closed[0].T_map_sensor, circuit.T_village_sensor) < 0.3);
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

  CHECK(closed[1].map_points_m == closed[0].map_points_m);
  CHECK(test::are_same(closed[1].T_map_sensor, closed[0].T_map_sensor));
}
