#pragma once

#include "hqslam/core/angles.h"
#include "hqslam/core/scan.h"
#include "hqslam/core/sensor_model.h"
#include "testing.h"

// Scans of places made for a test, stored ring after ring.
namespace hqslam::test {

/// A scan and, per point, the row that it was made with or is known to have.
struct KnownScan {
  Scan scan;
  std::vector<int> row;
  std::vector<double> angle_rad;  ///< since the ring began

  void add(const Eigen::Vector3f& point_m, int its_row, double its_angle_rad) {
    scan.points_m.push_back(point_m);
    row.push_back(its_row);
    angle_rad.push_back(its_angle_rad);
  }
};

struct RingOrder {
  double first_azimuth_rad = 0.0;
  double direction = 1.0;
};

struct Ray {
  int row;
  int step;  ///< of 1000
  double angle_rad;
  double tangent;
  /// How high above the origin the rings' lasers sit, as on an HDL-64E: near surfaces are seen
  /// under another elevation than far ones.
  double laser_m = 0.0;

  double ground_m(double height_m) const {
    return tangent < 0.0 ? (height_m + laser_m) / -tangent : 1e3;
  }
};

/// What a sensor without noise sees where a ray of it meets something after distance_m(ray) along
/// the ground, if that is within `reach_m`. `laser_m`: of a row.
KnownScan scan_of(const SensorModel& sensor, double reach_m, const auto& laser_m,
                  const auto& distance_m, const RingOrder& order = {}) {
  KnownScan known;
  for (int row = 0; row < sensor.rows(); ++row) {
    for (int step = 0; step < 1000; ++step) {
      const Ray ray{row, step, (step + 0.5) / 1000 * kTwoPi,
                    std::tan(sensor.beam_elevation_rad[row]), laser_m(row)};
      const double azimuth_rad = order.first_azimuth_rad + order.direction * ray.angle_rad;
      const double level_m = distance_m(ray, azimuth_rad);
      if (level_m > reach_m) continue;
      known.add(Eigen::Vector3d(level_m * std::cos(azimuth_rad), level_m * std::sin(azimuth_rad),
                                level_m * ray.tangent + ray.laser_m)
                    .cast<float>(),
                row, ray.angle_rad);
    }
  }
  return known;
}

/// A square with walls and open streets.
inline KnownScan a_square(const SensorModel& sensor, const RingOrder& order) {
  return scan_of(
      sensor, 100.0, [](int) { return 0.12; },
      [](const Ray& ray, double azimuth_rad) {
        const double wall_m =
            9.0 / std::max(std::abs(std::cos(azimuth_rad)), 0.05) + 2.0 * ray.row / 64;
        const double distance_m = std::min(wall_m, ray.tangent < 0.0 ? 1.7 / -ray.tangent : 1e3);
        return distance_m * ray.tangent > 4.0 ? 1e3 : distance_m;
      },
      order);
}

/// A wide square with a few things of different heights around: the higher a ring looks, the fewer
/// of them it sees, and the highest rings see nothing.
inline KnownScan an_open_square(const SensorModel& sensor) {
  return scan_of(
      sensor, 100.0, [](int) { return 0.0; },
      [](const Ray& ray, double) {
        const int thing = ray.step / 40;
        const double height_m = thing % 3 == 0 ? 0.4 * thing : -1.7;
        const double thing_m = 15.0 + thing % 5;
        const double ground_m = ray.ground_m(1.7);
        return thing_m * ray.tangent < height_m ? std::min(thing_m, ground_m) : ground_m;
      });
}

/// Of an HDL-64E: 0.20 m (the upper 32) and 0.13 m.
inline double two_blocks_m(int row) { return row < 32 ? 0.20 : 0.13; }

/// A street as an HDL-64E sees it: along a wall 4 m to the left that ends on both sides, with
/// nothing but sky over the street, houses at 30 m behind gaps to the right, and the ground.
inline KnownScan beside_a_wall(const SensorModel& sensor) {
  return scan_of(sensor, 80.0, two_blocks_m, [](const Ray& ray, double angle_rad) {
    double distance_m = ray.ground_m(1.73);
    if (angle_rad > 0.4 && angle_rad < 2.6) {
      distance_m = std::min(distance_m, 4.0 / std::sin(angle_rad));
    }
    const bool house = angle_rad > 3.6 && angle_rad < 5.6 && ray.step % 90 < 60;
    const double roof_m = 1.0 + ray.step / 90 % 3;  // the upper beams see some of them
    return house && 30.0 * ray.tangent < roof_m ? std::min(distance_m, 30.0) : distance_m;
  });
}

/// An alley 4 m wide as a unit sees it whose beams are off the table by up to 0.15 degrees.
inline KnownScan an_alley(SensorModel sensor) {
  for (int row = 0; row < sensor.rows(); ++row) {
    sensor.beam_elevation_rad[row] += 0.0026 * std::sin(2.0 * row * row);
  }
  return scan_of(sensor, 80.0, two_blocks_m, [](const Ray& ray, double angle_rad) {
    const double wall_m = (angle_rad < kTwoPi / 2.0 ? 1.6 : 2.4) / std::abs(std::sin(angle_rad));
    return std::min(wall_m, ray.ground_m(1.73));
  });
}

}  // namespace hqslam::test
