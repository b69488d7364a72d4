#include "hash.h"
#include "hqslam/core/connected_components.h"
#include "hqslam/core/projection.h"
#include "hqslam/core/trajectory.h"
#include "made_images.h"

// Made on x86-64. Compilers that fuse multiplications and additions, other vector instructions and
// another mathematics library could each change a last bit.
TEST_CASE("points, images, components and trajectories have the same bytes on every machine") {
  const SensorModel sensor = sensor_preset("os1-64");
  // Walls, posts and nothing, by whole numbers alone.
  const RangeImage scene = made_image(sensor.rows(), sensor.columns, [](int row, int column) {
    const int wall = 12 + (column / 64) % 5 + row % 3;
    const bool post = column % 97 < 4;
    const bool nothing = (row * 31 + column * 7) % 23 == 0;
    return nothing ? 0.0 : (post ? 8 : wall) + 0.125;
  });
  const OrganizedCloud cloud = unproject(scene, sensor, CaptureTime::kRolling);
  CHECK(hash_of(cloud.points_m) == 6862067664886597533U);
  CHECK(hash_of(cloud.time_offset_s) == 8085818488415593253U);

  Scan scan;
  scan.points_m = points_of(cloud);
  CHECK(hash_of(project(scan, sensor).cloud.range_m) == 3701233445619095456U);

  ComponentLabeler labeler(sensor, 10 * kDegree_rad);
  CHECK(hash_of(labeler.label(scene).label) == 10878368666235277583U);

  Trajectory trajectory{{0.0, Pose::Identity()}};
  const Pose step = pose_from_xyz_rpy({0.7, 0.03, -0.01}, 0.002, -0.003, 0.05);
  for (int i = 1; i < 200; ++i) {
    trajectory.push_back({0.1 * i, trajectory.back().T_map_sensor * step});
  }
  const TemporaryDirectory directory;
  write_tum(trajectory, directory.file("trajectory.tum"));
  CHECK(hash_of(file_contents(directory.file("trajectory.tum"))) == 14911819237509355218U);
}
