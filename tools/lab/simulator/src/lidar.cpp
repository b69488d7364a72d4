#include "lidar.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "echo.h"
#include "hqslam/core/angles.h"
#include "random.h"

namespace hqslam::sim {

namespace {

/// The keys of the random bits of a pixel: for rain, drop-outs and extra noise, for mixed
/// pixels, for how bright it is.
constexpr std::uint64_t kDisturbance = 1;
constexpr std::uint64_t kMixed = 2;
constexpr std::uint64_t kIntensity = 3;

/// Whether the beam may straddle an edge between two neighbouring pixels: the ranges differ by more
/// than a smooth surface would let them, the more the farther the rays are apart (radians). A rim
/// towards one side alone makes smooth ground look nearer or farther away than it is.
bool jumps(const std::optional<RayHit>& a, const std::optional<RayHit>& b, double apart) {
  if (!a || !b) return a.has_value() != b.has_value();
  const double near_m = std::min(a->range_m, b->range_m);
  const double grazing = std::min(a->cos_incidence, b->cos_incidence);
  const double slope = std::max(0.02, 1.8 * apart) / std::max(grazing, 0.05);
  return std::abs(a->range_m - b->range_m) > 0.15 + slope * near_m;
}

}  // namespace

/// One turn of the head. Pixels are independent of each other, so threads may share them.
struct Lidar::Revolution {
  const Lidar& lidar;
  const RayScene& scene;
  const std::vector<Pose>& T_world_sensor;
  std::uint64_t seed;
  RowSelection rows;
  RangeImage image{lidar.sensor_.rows(), lidar.sensor_.columns};
  /// The hit of the ray in the middle of each pixel.
  std::vector<std::optional<RayHit>> central{image.range_m.size()};

  std::optional<RayHit> cast(int row, int column, const Eigen::Vector3d& direction) const {
    const SensorModel& sensor = lidar.sensor_;
    const int firing = sensor.firing_column(row, column);
    const Pose& pose = T_world_sensor[static_cast<std::size_t>(firing)];
    // Windows show what is up to some metres behind them, never what is nearer.
    return scene.cast(pose.translation(), pose.linear() * direction,
                      (firing + 0.5) / sensor.columns, 1.1 * sensor.max_range_m);
  }

  /// The echoes of the middle of the beam and, where a neighbour is beyond a depth edge, of the rim
  /// of the beam towards that neighbour.
  Footprint footprint(int row, int column, const PixelBits& bits) const {
    const std::size_t pixel = image.index(row, column);
    Footprint footprint;
    const auto add = [&](const std::optional<RayHit>& hit, double weight) {
      const auto echo = hit ? echo_of(*hit, lidar.sensor_.max_range_m, bits) : std::nullopt;
      if (!echo) return;
      const double left = transmission(lidar.conditions_.extinction_per_m, echo->range_m);
      footprint.add(
          with_errors({echo->range_m, echo->signal * left}, hit->cos_incidence, lidar.pulse_),
          weight);
    };
    add(central[pixel], 2.0);
    constexpr std::array<std::array<int, 2>, 4> kNeighbours = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};
    for (const auto& [down, right] : kNeighbours) {
      if (row + down < 0 || row + down >= image.rows || !rows.contains(row + down)) continue;
      const std::size_t other =
          image.index(row + down, (column + right + image.columns) % image.columns);
      const Eigen::Vector3d& middle = lidar.directions_[pixel];
      const Eigen::Vector3d aside = lidar.directions_[other] - middle;
      if (!jumps(central[pixel], central[other], aside.norm())) continue;
      const Eigen::Vector3d towards = aside.normalized();
      add(cast(row, column, (middle + kHalfDivergence_rad * towards).normalized()), 1.0);
    }
    return footprint;
  }

  /// Factor of a return's intensity from its beam's gain and scatter; 1 for a sensor without
  /// errors.
  double intensity_factor(int row, const PixelBits& bits) const {
    const double scatter = lidar.pulse_.intensity_scatter;
    return lidar.beams_.intensity_gain[static_cast<std::size_t>(row)] *
           (1.0 + scatter * normal_of(seed_of(bits.pixel, kIntensity)));
  }

  Return reported(int row, int column) const {
    constexpr int kPatchRows = 3;
    constexpr int kPatchColumns = 5;
    const std::size_t patch = image.index(row / kPatchRows, column / kPatchColumns);
    const PixelBits bits{seed_of(seed, image.index(row, column)), seed_of(~seed, patch)};
    const SensorModel& sensor = lidar.sensor_;
    auto echo = footprint(row, column, bits)
                    .reported_echo(lidar.pulse_.mixed_share, seed_of(bits.pixel, kMixed));
    Return measured;
    if (echo) {
      echo->range_m += lidar.beams_.range_m[static_cast<std::size_t>(row)];
      measured.range_m =
          detected_range_m(*echo, sensor.min_range_m, sensor.max_range_m, bits.pixel);
      if (measured.range_m > 0.0F) {
        echo->signal *= intensity_factor(row, bits);
        measured.intensity = intensity_of(*echo, sensor.max_range_m);
      }
    }
    return disturbed_return(measured, lidar.conditions_, sensor, seed_of(bits.pixel, kDisturbance));
  }
};

Lidar::Lidar(const SensorModel& sensor, const DriveSpec& drive)
    : sensor_(sensor),
      conditions_(drive.conditions),
      beams_(draw_beam_errors(drive.sensor_errors, sensor.rows(), drive.seed)),
      pulse_(pulse_errors(drive.sensor_errors)),
      seed_(seed_of(drive.seed, DrivePart::kNoise)) {
  for (int row = 0; row < sensor_.rows(); ++row) {
    const auto beam = static_cast<std::size_t>(row);
    const double elevation_rad = sensor_.beam_elevation_rad[beam] + beams_.elevation_rad[beam];
    for (int column = 0; column < sensor_.columns; ++column) {
      const double azimuth_rad = sensor_.azimuth_rad(row, column) + beams_.azimuth_rad[beam];
      directions_.push_back(direction_of(azimuth_rad, elevation_rad));
    }
  }
}

RangeImage Lidar::measure(const RayScene& scene, const std::vector<Pose>& T_world_sensor,
                          std::int64_t scan, RowSelection selected,
                          std::vector<std::uint8_t>* intensity) const {
  Revolution turn{*this, scene, T_world_sensor, seed_of(seed_, static_cast<std::uint64_t>(scan)),
                  selected};
  const int rows = sensor_.rows();
  const int columns = sensor_.columns;
  if (intensity != nullptr) intensity->assign(directions_.size(), 0);
#pragma omp parallel for schedule(dynamic, 16)
  for (int column = 0; column < columns; ++column) {
    for (int row = selected.offset; row < rows; row += selected.stride) {
      const std::size_t pixel = turn.image.index(row, column);
      turn.central[pixel] = turn.cast(row, column, directions_[pixel]);
    }
  }
#pragma omp parallel for schedule(dynamic, 16)
  for (int column = 0; column < columns; ++column) {
    for (int row = selected.offset; row < rows; row += selected.stride) {
      const std::size_t pixel = turn.image.index(row, column);
      const Return reported = turn.reported(row, column);
      turn.image.range_m[pixel] = reported.range_m;
      if (intensity != nullptr) (*intensity)[pixel] = reported.intensity;
    }
  }
  return std::move(turn.image);
}

std::vector<Eigen::Vector3d> Lidar::visible_surface_m(
    const RayScene& scene, const std::vector<Pose>& T_world_sensor) const {
  const int rows = sensor_.rows();
  const int columns = sensor_.columns;
  std::vector<std::optional<Eigen::Vector3d>> seen_m(directions_.size());
#pragma omp parallel for schedule(dynamic, 1)
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::size_t pixel = static_cast<std::size_t>(row) * columns + column;
      const Pose& pose =
          T_world_sensor[static_cast<std::size_t>(sensor_.firing_column(row, column))];
      const Eigen::Vector3d direction = pose.linear() * directions_[pixel];
      const auto hit = scene.cast(pose.translation(), direction, 0.0, sensor_.max_range_m);
      if (!hit || hit->range_m < sensor_.min_range_m || is_glass(hit->surface.material)) continue;
      const auto echo = echo_of(*hit, sensor_.max_range_m, {});
      if (echo && echo->signal >= 1.0)
        seen_m[pixel] = pose.translation() + hit->range_m * direction;
    }
  }
  std::vector<Eigen::Vector3d> points_m;
  for (const auto& point_m : seen_m) {
    if (point_m) points_m.push_back(*point_m);
  }
  return points_m;
}

}  // namespace hqslam::sim
