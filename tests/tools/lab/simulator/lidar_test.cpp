#include "lidar.h"

#include "hqslam/core/projection.h"
#include "small_city.h"

using namespace hqslam::sim;

TEST_CASE("rows far apart see no edge in smooth ground: on average it is where it is") {
  City city = empty_city();
  add_quad(city.fixed, {-200.0, -200.0, 0.0}, {200.0, -200.0, 0.0}, {200.0, 200.0, 0.0},
           {-200.0, 200.0, 0.0}, {Material::kConcrete, 255});
  const RayScene scene(city);
  const SensorModel sensor = sensor_preset("os1-16");
  const std::vector<Pose> poses(sensor.columns, pose_from_xyz_rpy({3.0, 4.0, 1.8}, 0.0, 0.0, 0.0));
  const RangeImage image = Lidar(sensor, DriveSpec{}).measure(scene, poses, 0);
  const OrganizedCloud cloud = unproject(image, sensor, CaptureTime::kRolling);
  for (int row = 9; row < sensor.rows(); ++row) {  // from 4 degrees down
    CAPTURE(row);
    double sum_m = 0.0;
    int returns = 0;
    for (int column = 0; column < sensor.columns; ++column) {
      if (image.at(row, column) == 0.0F) continue;
      sum_m += (poses[0] * cloud.points_m[cloud.index(row, column)].cast<double>()).z();
      ++returns;
    }
    REQUIRE(returns > 900);
    CHECK(std::abs(sum_m / returns) < 0.001);  // before: up to 0.013
  }
}
