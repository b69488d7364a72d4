#include <doctest/doctest.h>

#include <limits>

#include "hqslam/core/error.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "hqslam/slam/slam.h"
#include "slam/village.h"
#include "slam/yard_drive.h"

using namespace hqslam;

namespace {

using Points = std::vector<Eigen::Vector3f>;

/// As a surveyor's scanner would have left it, in a frame of its own.
Points surveyed(const test::Village& village, const Pose& T_survey_street) {
  const SensorModel scanner = test::small_sensor(64, 1024);
  Points points_m;
  for (double x_m = -10.0; x_m <= 50.0; x_m += 4.0) {
    const Pose T_street_scanner = test::yard_pose(x_m, 0.0, 0.0);
    for (const Eigen::Vector3f& point_m : points_of(village.scan(scanner, T_street_scanner))) {
      points_m.push_back((T_survey_street * T_street_scanner).cast<float>() * point_m);
    }
  }
  return points_m;
}

slam::SavedMap map_of(const Points& points_m) {
  return slam::map_of_cloud(points_m, test::street_sensor(), slam::SlamOptions());
}

}  // namespace

TEST_CASE("a drive is located in a surveyed cloud of its street, and not in that of another") {
  const Pose T_survey_street = pose_from_xyz_rpy({200.0, -70.0, 30.0}, 0.0, 0.0, 1.0);
  const slam::SavedMap map = map_of(surveyed(test::street(31, -20.0, 80.0), T_survey_street));
  CHECK(map.places.size() > 20);
  slam::Slam here(test::street_sensor(), slam::SlamOptions(), map);
  slam::Slam elsewhere(test::street_sensor(), slam::SlamOptions(), map);
  for (int i = 0; i < 6; ++i) {
    const Pose T_street_sensor = test::yard_pose(22.0 - 0.5 * i, 1.0, 2.8);
    const auto report = here.process(test::street(31, -20.0, 80.0).scan(T_street_sensor), 0.1 * i);
    CAPTURE(i);
    CHECK(is_registered(report.mapping_status));
    const Pose error = report.T_map_sensor.inverse() * T_survey_street * T_street_sensor;
    CHECK(error.translation().norm() < 0.1);
    CHECK(rotation_angle_rad(error) < 0.01);
    CHECK(elsewhere.process(test::street(77, -20.0, 80.0).scan(T_street_sensor), 0.1 * i)
              .mapping_status == slam::Status::kNotRecognized);
  }
}

TEST_CASE(
    "a cloud that is none of a place is refused: not finite, far away, few points, no ground") {
  const Points good = surveyed(test::street(31, -20.0, 80.0), Pose::Identity());
  const auto refused = [](const Points& points_m, const char* why) {
    CHECK_THROWS_WITH_AS(map_of(points_m), doctest::Contains(why), Error);
  };
  Points bad = good;
  bad.back().x() = std::numeric_limits<float>::quiet_NaN();
  refused(bad, "km of its origin");
  bad.back().x() = 4.5e6F;
  refused(bad, "km of its origin");
  refused({}, "places of 0.1 m");
  refused(Points(good.begin(), good.begin() + 500), "places of 0.1 m");
  Points wall;
  for (float y_m = -20.0F; y_m < 20.0F; y_m += 0.1F) {
    for (float z_m = 0.0F; z_m < 5.0F; z_m += 0.1F) wall.emplace_back(0.0F, y_m, z_m);
  }
  refused(wall, "ground to stand on");
  Points centimetres = good;
  for (Eigen::Vector3f& point_m : centimetres) point_m *= 100.0F;
  refused(centimetres, "places of 0.1 m");
}

TEST_CASE("a sensor with one row, which tells no ground, is refused, and one that is none") {
  SensorModel sensor = test::street_sensor();
  sensor.beam_elevation_rad.resize(1);
  sensor.beam_azimuth_offset_rad.resize(1);
  CHECK_THROWS_WITH_AS(slam::map_of_cloud(surveyed(test::street(31, -20.0, 80.0), Pose::Identity()),
                                          sensor, slam::SlamOptions()),
                       doctest::Contains("two rows or more"), Error);
  sensor = test::street_sensor();
  std::swap(sensor.beam_elevation_rad.front(), sensor.beam_elevation_rad.back());
  CHECK_THROWS_WITH_AS(slam::map_of_cloud(surveyed(test::street(31, -20.0, 80.0), Pose::Identity()),
                                          sensor, slam::SlamOptions()),
                       doctest::Contains("elevations must fall"), Error);
}
