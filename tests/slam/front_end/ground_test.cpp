#include "front_end/ground.h"

#include "slam/yard.h"

namespace {

/// A cloud of 4 rows and 16 columns whose column 5 holds the given points, lowest beam last.
OrganizedCloud column_cloud(const SensorModel& sensor, const std::vector<Eigen::Vector3f>& points) {
  OrganizedCloud cloud(sensor.rows(), sensor.columns);
  for (int row = 0; row < 4; ++row) {
    const std::size_t pixel = cloud.index(row, 5);
    cloud.points_m[pixel] = points[row];
    cloud.range_m[pixel] = points[row].norm();
  }
  return cloud;
}

SensorModel downward_sensor() { return beams_at({-0.05, -0.1, -0.15, -0.2}, 16); }

std::vector<int> marked_rows(const std::vector<Eigen::Vector3f>& points) {
  const SensorModel sensor = downward_sensor();
  const auto ground = slam::mark_ground(column_cloud(sensor, points), sensor);
  std::vector<int> rows;
  for (int row = 0; row < 4; ++row) {
    if (ground[row * 16 + 5] != 0) rows.push_back(row);
  }
  return rows;
}

}  // namespace

TEST_CASE("a slope of 9 degrees is ground, one of 11 degrees is not") {
  const auto slope = [](double degrees) {
    std::vector<Eigen::Vector3f> points;
    for (const float x : {20.0F, 15.0F, 10.0F, 5.0F}) {
      points.emplace_back(x, 0.0F, -1.7F + x * static_cast<float>(std::tan(degrees * M_PI / 180)));
    }
    return points;
  };
  CHECK(marked_rows(slope(9.0)).size() == 4);
  CHECK(marked_rows(slope(11.0)).empty());
}

TEST_CASE("one beam without a return or two do not end the ground, three do") {
  CHECK(marked_rows({{12, 0, -1.7F}, {9, 0, -1.7F}, {0, 0, 0}, {5, 0, -1.7F}}) ==
        std::vector{0, 1, 3});
  CHECK(marked_rows({{12, 0, -1.7F}, {0, 0, 0}, {0, 0, 0}, {5, 0, -1.7F}}) == std::vector{0, 3});
  SensorModel five = downward_sensor();
  five.beam_elevation_rad.push_back(-0.25);
  five.beam_azimuth_offset_rad.push_back(0.0);
  OrganizedCloud cloud = column_cloud(five, {{12, 0, -1.7F}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  cloud.points_m[cloud.index(4, 5)] = {5.0F, 0.0F, -1.7F};
  cloud.range_m[cloud.index(4, 5)] = 5.3F;
  CHECK(slam::mark_ground(cloud, five) == std::vector<std::uint8_t>(5 * 16, 0));
}

TEST_CASE("points of beams above the horizon are no ground, however level they are") {
  SensorModel sensor = downward_sensor();
  sensor.beam_elevation_rad = {0.04, 0.03, 0.02, -0.05};
  // A ceiling 1 m above the sensor.
  CHECK(slam::mark_ground(column_cloud(sensor, {{25, 0, 1}, {33, 0, 1}, {50, 0, 1}, {0, 0, 0}}),
                          sensor) == std::vector<std::uint8_t>(4 * 16, 0));
}

TEST_CASE("the floor of a yard is ground and its walls are not, for 16, 32, 64 and 128 rows") {
  for (const char* name : {"vlp-16", "hdl-32e", "os1-64", "vls-128"}) {
    SensorModel sensor = sensor_preset(name);
    const Yard yard;
    const OrganizedCloud cloud = yard.scan(sensor, yard_pose(1, 2, 0.3));
    const auto ground = slam::mark_ground(cloud, sensor);
    int floor = 0;
    int floor_marked = 0;
    int other = 0;
    int other_marked = 0;
    for (std::size_t i = 0; i < ground.size(); ++i) {
      if (cloud.range_m[i] <= 0.0F || cloud.range_m[i] > 15.0F) continue;
      const bool on_floor = cloud.points_m[i].z() < -1.69F;
      (on_floor ? floor : other) += 1;
      (on_floor ? floor_marked : other_marked) += ground[i];
    }
    CAPTURE(name);
    CHECK(floor > 300);
    CHECK(floor_marked > 0.97 * floor);
    CHECK(other_marked < 0.03 * other);
  }
}
