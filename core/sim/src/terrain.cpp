#include "terrain.h"

#include <cmath>
#include <numbers>

#include "hqslam/core/pose.h"
#include "random.h"

namespace hqslam::sim {

Terrain::Terrain(std::uint64_t seed, double slope_bound) {
  Random random(seed);
  const double turn = random.uniform(0.0, std::numbers::pi);
  double wavelength_m = 520.0;
  for (std::size_t k = 0; k < waves_.size(); ++k) {
    // Directions spread over the half circle, so that no direction is left flat.
    const double direction_rad =
        turn + std::numbers::pi * (static_cast<double>(k * 5 % 6) + random.uniform(0.0, 0.7)) / 6.0;
    const double wave_number = 2.0 * std::numbers::pi / wavelength_m;
    waves_[k] = {wave_number * Eigen::Vector2d(std::cos(direction_rad), std::sin(direction_rad)),
                 slope_bound / static_cast<double>(waves_.size()) / wave_number,
                 random.uniform(0.0, 2.0 * std::numbers::pi)};
    wavelength_m *= random.uniform(0.72, 0.86);
  }
}

double Terrain::height_m(const Eigen::Vector2d& plane_m) const {
  double height_m = 0.0;
  for (const Wave& wave : waves_) {
    height_m +=
        wave.amplitude_m * std::sin(wave.wave_vector_rad_per_m.dot(plane_m) + wave.phase_rad);
  }
  return height_m;
}

Eigen::Vector2d Terrain::slope(const Eigen::Vector2d& plane_m) const {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (const Wave& wave : waves_) {
    slope += wave.amplitude_m * std::cos(wave.wave_vector_rad_per_m.dot(plane_m) + wave.phase_rad) *
             wave.wave_vector_rad_per_m;
  }
  return slope;
}

Eigen::Vector3d Terrain::ground(const Eigen::Vector2d& plane_m, double lift_m) const {
  return {plane_m.x(), plane_m.y(), height_m(plane_m) + lift_m};
}

Eigen::Isometry3d Terrain::frame(const Eigen::Vector2d& plane_m, double heading_rad) const {
  const Eigen::Vector2d rise = slope(plane_m);
  const Eigen::Vector2d forward(std::cos(heading_rad), std::sin(heading_rad));
  const Eigen::Vector2d left(-forward.y(), forward.x());
  return pose_from_xyz_rpy(ground(plane_m, 0.0), std::atan(rise.dot(left)),
                           -std::atan(rise.dot(forward)), heading_rad);
}

}  // namespace hqslam::sim
