#include "hqslam/slam/occupancy_grid.h"

#include "slam/yard_drive.h"

using namespace hqslam::slam;

namespace {

constexpr int kScans = 30;

/// A box of a car's size that is in the yard during some scans.
struct Car {
  Box box;
  int from_scan = 0, to_scan = kScans;
};

/// Ranges cut off where the car is.
void put_in(const Car& car, const SensorModel& sensor, const SensorPath& path,
            OrganizedCloud& cloud) {
  for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
    const Pose T_yard_sensor = path.at(cloud.time_offset_s[pixel]);
    const int row = static_cast<int>(pixel) / cloud.columns;
    const int column = static_cast<int>(pixel) % cloud.columns;
    const Eigen::Vector3d ray =
        direction_of(sensor.azimuth_rad(row, column), sensor.beam_elevation_rad[row]);
    const double enters_m =
        car.box.entered_m(T_yard_sensor.translation(), T_yard_sensor.linear() * ray);
    if (!std::isfinite(enters_m)) continue;
    if (cloud.range_m[pixel] > 0.0F && cloud.range_m[pixel] < enters_m) continue;
    cloud.range_m[pixel] = static_cast<float>(enters_m);
    cloud.points_m[pixel] = (enters_m * ray).cast<float>();
  }
}

/// The grid of a drive round the yard, in the yard's frame.
OccupancyMap yard_map(const std::optional<Car>& car = std::nullopt, bool backwards = false) {
  // With a car, columns dense enough to detect that it left.
  const SensorModel sensor = small_sensor(16, car ? 1024 : 512);
  Trajectory trajectory;
  for (int i = 0; i < kScans; ++i) {
    trajectory.push_back({i * kDrivePeriod_s, drive_pose(i * kDrivePeriod_s)});
  }
  OccupancyGrid grid({});
  const auto for_each_scan = [&](const auto& use) {
    for (int k = 0; k < kScans; ++k) {
      const int i = backwards ? kScans - 1 - k : k;
      const SensorPath path(trajectory, static_cast<std::size_t>(i));
      OrganizedCloud scan = drive_scan(sensor, i);
      if (car && i >= car->from_scan && i < car->to_scan) put_in(*car, sensor, path, scan);
      use(scan, path);
    }
  };
  for_each_scan([&](const auto& scan, const auto& path) { grid.add_ground(scan, sensor, path); });
  for_each_scan([&](const auto& scan, const auto& path) { grid.insert(scan, std::nullopt, path); });
  for_each_scan([&](const auto& scan, const auto& path) { grid.see_through(scan, path); });
  CHECK_FALSE(grid.is_full());
  return grid.map();
}

double share(const OccupancyMap& map, const Eigen::Vector2d& low_m, const Eigen::Vector2d& high_m,
             Occupancy occupancy) {
  int all = 0;
  int so = 0;
  for (double x_m = low_m.x(); x_m < high_m.x(); x_m += 0.1) {
    for (double y_m = low_m.y(); y_m < high_m.y(); y_m += 0.1) {
      ++all;
      if (map.at({x_m, y_m}) == occupancy) ++so;
    }
  }
  return static_cast<double>(so) / all;
}

}  // namespace

TEST_CASE("the floor of a yard is free, its walls and pillars are occupied, beyond is unknown") {
  const OccupancyMap map = yard_map();
  CHECK(share(map, {-8.0, -5.0}, {8.0, 5.0}, Occupancy::kFree) > 0.95);
  CHECK(share(map, {-8.0, -5.0}, {8.0, 5.0}, Occupancy::kOccupied) == 0.0);
  // The wall at y = 20: any of the two cells that touch it.
  int met = 0;
  for (double x_m = -10.0; x_m < 10.0; x_m += 0.1) {
    met += map.at({x_m, 19.95}) == Occupancy::kOccupied ||
           map.at({x_m, 20.05}) == Occupancy::kOccupied;
  }
  CHECK(met > 120);
  CHECK(share(map, {0.6, 8.6}, {1.4, 9.4}, Occupancy::kOccupied) > 0.15);  // a pillar's sides
  CHECK(share(map, {-10.0, 21.0}, {10.0, 25.0}, Occupancy::kUnknown) > 0.99);
  CHECK(map.at({1e9, 0.0}) == Occupancy::kUnknown);
}

TEST_CASE("a parked car is in the map, one that drove away is not") {
  const Car car{{{6.0, -7.0, 0.0}, {10.0, -5.2, 1.5}}};
  CHECK(share(yard_map(car), {6.0, -5.3}, {10.0, -5.1}, Occupancy::kOccupied) > 0.3);
  Car leaving = car;
  leaving.to_scan = 8;
  const OccupancyMap left = yard_map(leaving);
  CHECK(share(left, {5.5, -7.5}, {10.5, -4.7}, Occupancy::kOccupied) < 0.02);
  CHECK(share(left, {5.5, -7.5}, {10.5, -4.7}, Occupancy::kFree) > 0.8);
}

TEST_CASE("the same scans give the same map in any order") {
  const OccupancyMap map = yard_map();
  const OccupancyMap backwards = yard_map(std::nullopt, true);
  CHECK(backwards.rows == map.rows);
  CHECK(backwards.columns == map.columns);
  CHECK(backwards.origin_m == map.origin_m);
  CHECK(backwards.cells == map.cells);
}

TEST_CASE("a sensor that hangs upside down makes the same map") {
  const SensorModel sensor = small_sensor();
  SensorModel hanging = sensor;
  std::ranges::reverse(hanging.beam_elevation_rad);
  for (double& elevation_rad : hanging.beam_elevation_rad) elevation_rad = -elevation_rad;
  const Pose turn(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  OccupancyGrid upright({});
  OccupancyGrid upside_down({});
  const Pose T_map_sensor = yard_pose(0, 0, 0);
  upright.add_ground(Yard().scan(sensor, T_map_sensor), sensor, SensorPath(T_map_sensor));
  upright.see_through(Yard().scan(sensor, T_map_sensor), SensorPath(T_map_sensor));
  const SensorPath path(T_map_sensor * turn);
  upside_down.add_ground(Yard().scan(hanging, T_map_sensor * turn), hanging, path);
  upside_down.see_through(Yard().scan(hanging, T_map_sensor * turn), path);
  const auto free_m2 = [](const OccupancyMap& map) {
    return 0.01 * static_cast<double>(std::ranges::count(map.cells, Occupancy::kFree));
  };
  CHECK(free_m2(upright.map()) > 100.0);
  CHECK(free_m2(upside_down.map()) == doctest::Approx(free_m2(upright.map())).epsilon(0.02));
}

TEST_CASE("wrong options, scans of another sensor and drives without ground are one line") {
  CHECK(refused_with([] { OccupancyGrid grid({.resolution_m = 0.0}); }, "resolution_m"));
  for (const double highest_m : {0.2, std::nan("")}) {
    CHECK(refused_with([&] { validate(OccupancyGridOptions{.highest_obstacle_m = highest_m}); },
                       "highest_obstacle_m"));
  }
  const SensorModel sensor = small_sensor();
  OccupancyGrid grid({});
  const OrganizedCloud nothing(sensor.rows(), sensor.columns);
  const SensorPath path(yard_pose(0, 0, 0));
  CHECK(refused_with([&] { grid.add_ground(nothing, small_sensor(8), path); }, "16x512"));
  grid.add_ground(nothing, sensor, path);
  grid.insert(nothing, std::nullopt, path);
  grid.see_through(nothing, path);
  CHECK(refused_with([&] { static_cast<void>(grid.map()); }, "z axis points up"));
}

TEST_CASE("points and places out of all bounds are left out") {
  const SensorModel sensor = small_sensor();
  OrganizedCloud scan = Yard().scan(sensor, yard_pose(0, 0, 0));
  for (std::size_t pixel = 0; pixel < scan.points_m.size(); pixel += 7) {
    scan.points_m[pixel] *= 1e30F;
    scan.range_m[pixel] = 5.0F;
  }
  OccupancyGrid grid({});
  for (const double x_m : {0.0, 1e9}) {
    const SensorPath path(yard_pose(x_m, 0, 0));
    grid.add_ground(scan, sensor, path);
    grid.insert(scan, std::nullopt, path);
    grid.see_through(scan, path);
  }
  CHECK(grid.map().columns < 700);
}

TEST_CASE("a map as large as a country is refused before it is made") {
  const SensorModel sensor = small_sensor();
  const OrganizedCloud scan = Yard().scan(sensor, yard_pose(0, 0, 0));
  OccupancyGrid grid({});
  std::vector<SensorPath> corners;
  for (const double x_m : {0.0, 9e5}) {
    for (const double y_m : {0.0, 9e5}) {
      corners.emplace_back(Pose(Eigen::Translation3d(x_m, y_m, 0.0)));
    }
  }
  for (const SensorPath& path : corners) grid.add_ground(scan, sensor, path);
  for (const SensorPath& path : corners) grid.see_through(scan, path);
  CHECK(refused_with([&] { static_cast<void>(grid.map()); }, "give larger ones"));
}
