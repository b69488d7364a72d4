#include "front_end/ground.h"

#include <cmath>

#include "hqslam/core/angles.h"

namespace hqslam::slam {

namespace {

/// Beams higher than this do not meet the ground within a useful distance.
constexpr double kHighestGroundBeam_rad = -0.5 * kDegree_rad;

/// Largest number of beams without a return between two compared ones.
constexpr int kMaxMissingBeams = 2;

/// Vertical and horizontal component of each row's beams, frame of the sensor.
struct Beams {
  std::vector<double> up;
  std::vector<double> ahead;
};

Beams beams_of(const SensorModel& sensor) {
  Beams beams;
  for (const double elevation_rad : sensor.beam_elevation_rad) {
    beams.up.push_back(std::sin(elevation_rad));
    beams.ahead.push_back(std::cos(elevation_rad));
  }
  return beams;
}

/// The first row from which on all beams of an azimuth point below the horizon.
int highest_ground_row(const Beams& beams, double azimuth_rad,
                       const Eigen::Vector3d& up_of_sensor) {
  const double up_ahead =
      up_of_sensor.x() * std::cos(azimuth_rad) + up_of_sensor.y() * std::sin(azimuth_rad);
  const double highest = std::sin(kHighestGroundBeam_rad);
  auto row = beams.up.size();
  while (row > 0 &&
         up_ahead * beams.ahead[row - 1] + up_of_sensor.z() * beams.up[row - 1] <= highest) {
    --row;
  }
  return static_cast<int>(row);
}

void mark_column(const OrganizedCloud& cloud, int highest_row, int column, float max_slope_squared,
                 std::vector<std::uint8_t>& ground) {
  int lower_row = -1;
  for (int row = cloud.rows - 1; row >= highest_row; --row) {
    const std::size_t upper = cloud.index(row, column);
    if (cloud.range_m[upper] <= 0.0F) continue;
    if (lower_row >= 0 && lower_row - row <= kMaxMissingBeams + 1) {
      const std::size_t lower = cloud.index(lower_row, column);
      const Eigen::Vector3f step_m = cloud.points_m[upper] - cloud.points_m[lower];
      if (step_m.z() * step_m.z() <= max_slope_squared * step_m.head<2>().squaredNorm()) {
        ground[upper] = 1;
        ground[lower] = 1;
      }
    }
    lower_row = row;
  }
}

}  // namespace

std::vector<std::uint8_t> mark_ground(const OrganizedCloud& cloud, const SensorModel& sensor,
                                      const Eigen::Vector3d& up_of_sensor, double max_slope_rad) {
  std::vector<std::uint8_t> ground(cloud.range_m.size(), 0);
  const Beams beams = beams_of(sensor);
  const auto max_slope = static_cast<float>(std::tan(max_slope_rad));
#pragma omp parallel for schedule(static)
  for (int column = 0; column < cloud.columns; ++column) {
    const double azimuth_rad = sensor.azimuth_rad(0, column) - sensor.residual_azimuth_rad(0);
    mark_column(cloud, highest_ground_row(beams, azimuth_rad, up_of_sensor), column,
                max_slope * max_slope, ground);
  }
  return ground;
}

}  // namespace hqslam::slam
