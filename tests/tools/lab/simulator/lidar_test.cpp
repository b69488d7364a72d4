#include "lidar.h"

#include "hqslam/core/projection.h"
#include "hqslam/core/sensor_model.h"
#include "small_city.h"
#include "testing.h"

using namespace hqslam;
using namespace hqslam::sim;
using namespace hqslam::test;

namespace {

void add_floor(TriangleMesh& mesh) {
  add_quad(mesh, {-200.0, -200.0, 0.0}, {200.0, -200.0, 0.0}, {200.0, 200.0, 0.0},
           {-200.0, 200.0, 0.0}, {Material::kConcrete, 255});
}

/// A head that drives along x and turns while it spins.
std::vector<Pose> moving_head(const SensorModel& sensor, double speed_mps, double yaw_rate) {
  std::vector<Pose> poses;
  for (int column = 0; column < sensor.columns; ++column) {
    const double time_s = ((column + 0.5) / sensor.columns - 0.5) * sensor.scan_period_s;
    poses.push_back(pose_from_xyz_rpy({speed_mps * time_s, 0.0, 1.8}, 0.0, 0.0, yaw_rate * time_s));
  }
  return poses;
}

/// Calls visit(row, column, point) for every return; points as the head sees them at their column.
template <typename Visit>
int for_each_return(const RangeImage& image, const SensorModel& sensor, const Visit& visit) {
  const OrganizedCloud cloud = unproject(image, sensor, CaptureTime::kRolling);
  int returns = 0;
  for (int row = 0; row < sensor.rows(); ++row) {
    for (int column = 0; column < sensor.columns; ++column) {
      if (!image.has_return(row, column)) continue;
      ++returns;
      visit(row, column, cloud.points_m[cloud.index(row, column)].cast<double>());
    }
  }
  return returns;
}

}  // namespace

TEST_CASE("rows far apart see no edge in smooth ground: on average it is where it is") {
  City city = empty_city();
  add_floor(city.fixed);
  const RayScene scene(city);
  const SensorModel sensor = sensor_preset("os1-16");
  const std::vector<Pose> poses(static_cast<std::size_t>(sensor.columns),
                                pose_from_xyz_rpy({3.0, 4.0, 1.8}, 0.0, 0.0, 0.0));
  const RangeImage image = Lidar(sensor, DriveSpec{}).measure(scene, poses, 0);
  std::vector<double> sum_m(static_cast<std::size_t>(sensor.rows()), 0.0);
  std::vector<int> returns(sum_m.size(), 0);
  for_each_return(image, sensor, [&](int row, int /*column*/, const Eigen::Vector3d& point) {
    sum_m[static_cast<std::size_t>(row)] += (poses[0] * point).z();
    ++returns[static_cast<std::size_t>(row)];
  });
  for (std::size_t row = 9; row < sum_m.size(); ++row) {  // from 4 degrees down
    CAPTURE(row);
    REQUIRE(returns[row] > 900);
    CHECK(std::abs(sum_m[row] / returns[row]) < 0.001);  // before: up to 0.013
  }
}

TEST_CASE("rolling capture: with the pose of each column walls are straight, with one pose not") {
  City city = empty_city();
  add_wall(city.fixed, 15.0, -60.0, 60.0);
  add_wall(city.fixed, -20.0, -60.0, 60.0);
  const RayScene scene(city);
  const SensorModel sensor = small_sensor();
  const std::vector<Pose> poses = moving_head(sensor, 15.0, 0.8);
  const RangeImage image = Lidar(sensor, DriveSpec{}).measure(scene, poses, 0);
  const Pose middle = pose_from_xyz_rpy({0.0, 0.0, 1.8}, 0.0, 0.0, 0.0);
  double largest_m = 0.0;
  double largest_with_one_pose_m = 0.0;
  const auto from_wall = [](const Eigen::Vector3d& point) {
    return std::min(std::abs(point.x() - 15.0), std::abs(point.x() + 20.0));
  };
  const int returns =
      for_each_return(image, sensor, [&](int row, int column, const Eigen::Vector3d& point) {
        const auto firing = static_cast<std::size_t>(sensor.firing_column(row, column));
        largest_m = std::max(largest_m, from_wall(poses[firing] * point));
        largest_with_one_pose_m = std::max(largest_with_one_pose_m, from_wall(middle * point));
      });
  CHECK(returns > 500);
  CHECK(largest_m < 0.06);
  CHECK(largest_with_one_pose_m > 0.5);
}
