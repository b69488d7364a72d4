#pragma once

#include "city.h"
#include "made_images.h"

namespace hqslam::test {

/// 16 beams from +10 to -20 degrees with azimuth offsets of some columns, 128 columns.
inline SensorModel small_sensor() {
  SensorModel sensor = even_sensor(16, 128, 10.0, 2.0);
  for (int row = 0; row < 16; ++row) {
    sensor.beam_azimuth_offset_rad[row] = (row % 2 == 0 ? 4.0 : -4.0) * kDegree_rad;
  }
  return sensor;
}

/// A city without anything in it: its layout is that of a block drive, the rest is for the test to
/// add.
inline sim::City empty_city() {
  return {{.fixed = {}, .prototypes = {}, .placements = {}},
          sim::make_layout(sim::drive_style("block").city, 1)};
}

/// A vertical wall in the plane x = `x_m`, from y0 to y1, 20 m high.
inline void add_wall(sim::TriangleMesh& mesh, double x_m, double y0_m, double y1_m,
                     std::uint8_t shade = 255) {
  sim::add_quad(mesh, {x_m, y0_m, -10.0}, {x_m, y1_m, -10.0}, {x_m, y1_m, 10.0}, {x_m, y0_m, 10.0},
                {sim::Material::kPlaster, shade});
}

/// Somewhere in a box around the origin, whose sides are twice `half_m` long.
inline Eigen::Vector3d random_point(sim::Random& random, const Eigen::Vector3d& half_m) {
  const double x = random.uniform(-half_m.x(), half_m.x());
  const double y = random.uniform(-half_m.y(), half_m.y());
  return {x, y, random.uniform(-half_m.z(), half_m.z())};
}

}  // namespace hqslam::test
