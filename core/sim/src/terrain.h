#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

namespace hqslam::sim {

/// Smooth hills: a sum of plane waves, so that height and slope are known in closed form.
///   height(p) = sum_k a_k sin(w_k . p + phase_k),  sum_k a_k |w_k| <= slope_bound
class Terrain {
 public:
  Terrain(std::uint64_t seed, double slope_bound);
  double height_m(const Eigen::Vector2d& plane_m) const;
  /// d height / d (x, y).
  Eigen::Vector2d slope(const Eigen::Vector2d& plane_m) const;
  /// The point of the terrain at `plane_m`, lifted.
  Eigen::Vector3d ground(const Eigen::Vector2d& plane_m, double lift_m) const;
  /// Frame of something that stands on the terrain and looks along `heading_rad`: x forward, z
  /// along the terrain's normal to first order.
  ///   pitch = -atan(slope along x), roll = atan(slope along y)
  Eigen::Isometry3d frame(const Eigen::Vector2d& plane_m, double heading_rad) const;

 private:
  struct Wave {
    Eigen::Vector2d wave_vector_rad_per_m;
    double amplitude_m;
    double phase_rad;
  };
  std::array<Wave, 6> waves_;
};

}  // namespace hqslam::sim
