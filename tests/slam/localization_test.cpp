#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "hqslam/slam/slam.h"
#include "slam/village.h"
#include "slam/yard_drive.h"

using slam::Status;

namespace {

Pose street_pose(double x_m, double y_m = 0.0, double yaw_rad = 0.0) {
  return yard_pose(x_m, y_m, yaw_rad);
}

/// What a drive along a street, from x = 0 to 80 m, leaves behind.
slam::SavedMap driven(const Village& village) {
  slam::Slam slam(street_sensor());
  for (int i = 0; i <= 80; ++i) {
    slam.process(village.scan(street_pose(kStreetStep_m * i)), 0.1 * i);
  }
  slam.finish();
  return slam.saved_map();
}

slam::Slam located_in(const slam::SavedMap& map, const std::optional<Pose>& T_map_start = {}) {
  return slam::Slam(street_sensor(), slam::SlamOptions(), map, T_map_start);
}

/// Where a scan of the street is in that map: its first scan is the origin.
Pose in_map(const Pose& T_street_sensor) { return street_pose(0.0).inverse() * T_street_sensor; }

double error_m(const Pose& T_map_sensor, const Pose& T_street_sensor) {
  return (T_map_sensor.translation() - in_map(T_street_sensor).translation()).norm();
}

}  // namespace

TEST_CASE("a drive is located in an earlier one's map from any start, and leaves that unchanged") {
  const Village village = street(31);
  const slam::SavedMap map = driven(village);
  CHECK(map.places.size() >= 18);
  for (const double yaw_rad : {0.3, std::numbers::pi}) {
    CAPTURE(yaw_rad);
    slam::Slam slam = located_in(map);
    const std::size_t points = slam.map_points_m().size();
    for (int i = 0; i < 10; ++i) {
      const Pose T_street_sensor = street_pose(43.0, 1.0 - 0.2 * i, yaw_rad);
      const auto report = slam.process(village.scan(T_street_sensor), 0.1 * i);
      CAPTURE(i);
      CHECK(report.mapping_status == Status::kOk);
      CHECK(error_m(report.T_map_sensor, T_street_sensor) < 0.05);
      CHECK(rotation_angle_rad(report.T_map_sensor.inverse() * in_map(T_street_sensor)) < 0.005);
      CHECK(report.covariance.trace() < 1.0);
      CHECK(report.covariance.diagonal().minCoeff() > 0.0);
      CHECK_FALSE(report.keyframe);
    }
    CHECK(slam.map_points_m().size() == points);
  }
}

TEST_CASE("a map that scans fit half as well as those of its own drive did is in doubt") {
  const Village village = street(31);
  slam::SavedMap map = driven(village);
  const auto check = [&](Status expected) {
    slam::Slam slam = located_in(map);
    for (int i = 0; i < 25; ++i) {
      const auto report = slam.process(village.scan(street_pose(43.0 + 0.2 * i)), 0.1 * i);
      CAPTURE(i);
      CHECK(is_registered(report.mapping_status));
      CHECK(report.mapping_status == expected);
    }
  };
  check(Status::kOk);
  for (auto* points_m : {&map.edges_m, &map.posts_m, &map.planes_m}) {
    std::erase_if(*points_m, [](const Eigen::Vector3f& p_m) { return p_m.y() > -1.0F; });
  }
  check(Status::kMapInDoubt);
  map.close_ratio = 0.0;  // unknown
  check(Status::kOk);
}

TEST_CASE("a place outside of the map is not recognized, and one inside is after it") {
  const slam::SavedMap map = driven(street(31));
  slam::Slam slam = located_in(map);
  for (int i = 0; i < 5; ++i) {
    const auto report = slam.process(street(77).scan(street_pose(30.0 + i)), 0.1 * i);
    CHECK(report.mapping_status == Status::kNotRecognized);
    CHECK_FALSE(is_registered(report.mapping_status));
    CHECK(std::isinf(report.covariance(0, 0)));
  }
  const auto report = slam.process(street(31).scan(street_pose(30.0)), 0.5);
  CHECK(report.mapping_status != Status::kNotRecognized);
  CHECK(error_m(report.T_map_sensor, street_pose(30.0)) < 0.05);
  const double sigma_m = std::sqrt(report.covariance(0, 0));
  CHECK(sigma_m > 0.001);  // of one scan against the map, not as far as it was carried
  CHECK(sigma_m < 0.2);
}

TEST_CASE("a sensor that is covered at first, or later, is recognized when it is uncovered") {
  const Village village = street(31);
  slam::Slam slam = located_in(driven(village));
  OrganizedCloud nothing = village.scan(street_pose(30.0));
  std::ranges::fill(nothing.range_m, 0.0F);
  int scan = 0;
  Pose T_odom_before = Pose::Identity();
  // The odometry's path does not begin again, and nowhere does it jump.
  const auto process = [&](const OrganizedCloud& cloud) {
    const slam::ScanReport report = slam.process(cloud, 0.1 * scan++);
    CHECK((T_odom_before.inverse() * report.T_odom_sensor).translation().norm() < 0.3);
    T_odom_before = report.T_odom_sensor;
    return report;
  };
  for (const int covered : {3, 20}) {
    CAPTURE(covered);
    slam::ScanReport last;
    for (int i = 0; i < covered; ++i) last = process(nothing);
    CHECK(last.mapping_status == Status::kNotRecognized);
    for (int i = 0; i < 5; ++i) {
      const Pose T_street_sensor = street_pose(30.0 + covered + 0.2 * i);
      const auto report = process(village.scan(T_street_sensor));
      CAPTURE(i);
      CHECK(is_registered(report.mapping_status));
      CHECK(error_m(report.T_map_sensor, T_street_sensor) < 0.1);
    }
    CHECK(T_odom_before.translation().norm() > 0.5);
  }
}

TEST_CASE("of two halves that are alike the given start decides") {
  const Village village = street_of_two_equal_halves();
  const slam::SavedMap map = driven(village);
  const Pose truth = street_pose(68.0, 0.5, 0.1);
  const OrganizedCloud scan = village.scan(truth);
  CHECK(located_in(map).process(scan, 0.0).mapping_status == Status::kNotRecognized);
  const auto report = located_in(map, in_map(street_pose(64.0, 0.0, 0.3))).process(scan, 0.0);
  CHECK(report.mapping_status == Status::kOk);
  CHECK(error_m(report.T_map_sensor, truth) < 0.1);
}

TEST_CASE("a sensor carried along the street is found there after a few scans") {
  const Village village = street(31);
  slam::Slam slam = located_in(driven(village));
  int located = 0;
  for (int i = 0; i < 20; ++i) {
    const Pose T_street_sensor = street_pose(i < 8 ? 20.0 : 65.0, 0.0, i < 8 ? 0.0 : 2.0);
    const auto report = slam.process(village.scan(T_street_sensor), 0.1 * i);
    if (!is_registered(report.mapping_status)) continue;
    ++located;
    CHECK(error_m(report.T_map_sensor, T_street_sensor) < 0.05);
  }
  CHECK(located >= 13);
}

TEST_CASE("a sensor that spins fast is located in a given map as one that stands is") {
  slam::Slam mapped(street_sensor());
  for (int i = 0; i < 40; ++i) mapped.process(drive_scan(street_sensor(), i), 0.1 * i);
  mapped.finish();
  const Pose T_yard_start = drive_pose(2.0);
  const Pose T_map_yard = drive_pose(0.0).inverse();
  const auto T_yard_sensor = [&](double time_s) {
    const double turned_rad = 0.75 * time_s * std::abs(time_s);
    return Pose(T_yard_start * Eigen::AngleAxisd(turned_rad, Eigen::Vector3d::UnitZ()));
  };
  slam::Slam slam = located_in(mapped.saved_map(), T_map_yard * T_yard_start);
  for (int i = 0; i < 40; ++i) {
    const auto report =
        slam.process(Yard().rolling_scan(street_sensor(),
                                         [&](double t_s) { return T_yard_sensor(0.1 * i + t_s); }),
                     0.1 * i);
    const Pose error = report.T_map_sensor.inverse() * T_map_yard * T_yard_sensor(0.1 * i);
    CAPTURE(i);
    CHECK(is_registered(report.mapping_status));
    CHECK(error.translation().norm() < 0.1);
    CHECK(rotation_angle_rad(error) < 0.01);
  }
}

TEST_CASE("a map needs places; none is saved without loop closing or in a given map") {
  const slam::SavedMap empty;
  CHECK_THROWS_WITH_AS(located_in(empty), doctest::Contains("expected a map with places"), Error);
  slam::SlamOptions open;
  open.loop_closing.enabled = false;
  CHECK_THROWS_WITH_AS(slam::Slam(street_sensor(), open).saved_map(),
                       doctest::Contains("loop closing"), Error);
  const slam::Slam given = located_in(driven(street(31)));
  CHECK_THROWS_WITH_AS(given.saved_map(), doctest::Contains("given map"), Error);
}
