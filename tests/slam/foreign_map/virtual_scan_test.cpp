#include "foreign_map/virtual_scan.h"

#include <doctest/doctest.h>

#include <cmath>

#include "hqslam/core/sensor_model.h"

using namespace hqslam;

namespace {

/// An upright wall across x, a surfel every 0.1 m.
void add_wall(std::vector<slam::Surfel>& surfels, float x_m, float half_width_m) {
  for (float y_m = -half_width_m; y_m <= half_width_m; y_m += 0.1F) {
    for (float z_m = -3.0F; z_m <= 3.0F; z_m += 0.1F) {
      surfels.push_back({{x_m, y_m, z_m}, Eigen::Vector3f::UnitX(), 0.075F});
    }
  }
}

}  // namespace

TEST_CASE("beams end on the nearest wall, at the distance of its plane, wherever they meet it") {
  std::vector<slam::Surfel> surfels;
  add_wall(surfels, 10.0F, 8.0F);
  add_wall(surfels, 5.0F, 1.0F);
  const slam::SurfelTiles tiles(surfels);
  const SensorModel sensor = slam::virtual_sensor(sensor_preset("vlp-16"));
  CHECK(sensor.rows() == 64);
  const slam::VirtualScanner scanner(sensor, tiles, tiles);
  const OrganizedCloud cloud = scanner.scan(pose_from_xyz_rpy({1.0, 0.0, 0.0}, 0.0, 0.0, 0.0));
  int near = 0;
  int far = 0;
  for (const Eigen::Vector3f& point_m : cloud.points_m) {
    if (point_m.isZero()) continue;
    const bool is_near = std::abs(point_m.x() - 4.0F) < 1e-3F;
    const bool is_far = std::abs(point_m.x() - 9.0F) < 1e-3F;
    REQUIRE((is_near || is_far));
    near += is_near ? 1 : 0;
    far += is_far ? 1 : 0;
    // What is hidden by the near wall is not seen.
    if (is_far) CHECK(std::abs(point_m.y()) > 9.0F / 4.0F * 0.95F);
  }
  CHECK(near > 1000);
  CHECK(far > 1000);
  CHECK(cloud.range_m[cloud.index(32, 0)] == 0.0F);  // nothing behind
}
