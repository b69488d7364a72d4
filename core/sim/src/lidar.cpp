#include "lidar.h"

#include <algorithm>
#include <cmath>

#include "disturbance.h"
#include "echo.h"
#include "random.h"

namespace hqslam::sim {

namespace {

/// Half of the beam's divergence: 3 mrad in all, between those of the presets' sensors.
constexpr double kHalfDivergence_rad = 0.0015;

/// The key of the random bits that rain, drop-outs and extra noise draw from.
constexpr std::uint64_t kDisturbance = 1;

/// One ray per pixel.
struct CentralRays {
  std::vector<RayHit> hits;
  std::vector<char> met;  ///< whether there is a hit
};

struct NeighbourStep {
  int row;
  int column;
};
constexpr std::array<NeighbourStep, 4> kNeighbours = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}}};

/// Whether the beam may straddle an edge between two neighbouring pixels: the ranges differ by more
/// than a smooth surface would let them.
bool jumps(const CentralRays& rays, std::size_t a, std::size_t b) {
  if (rays.met[a] == 0 || rays.met[b] == 0) return rays.met[a] != rays.met[b];
  const double near_m = std::min(rays.hits[a].range_m, rays.hits[b].range_m);
  const double gap_m = std::abs(rays.hits[a].range_m - rays.hits[b].range_m);
  const double grazing = std::min(rays.hits[a].cos_incidence, rays.hits[b].cos_incidence);
  return gap_m > 0.15 + 0.02 * near_m / std::max(grazing, 0.05);
}

/// The measurement of one scan; its parts are independent per pixel, so threads may share them.
class Measurement {
 public:
  Measurement(const SensorModel& sensor, const SensingConditions& conditions,
              const std::vector<Eigen::Vector3d>& directions, const RayScene& scene,
              const std::vector<Pose>& T_world_sensor, std::uint64_t seed)
      : sensor_(sensor),
        conditions_(conditions),
        directions_(directions),
        scene_(scene),
        T_world_sensor_(T_world_sensor),
        seed_(seed),
        image_(sensor.rows(), sensor.columns) {
    central_.hits.resize(image_.range_m.size());
    central_.met.resize(image_.range_m.size());
  }

  RangeImage take() {
    const int columns = sensor_.columns;
#pragma omp parallel for schedule(dynamic, 16)
    for (int column = 0; column < columns; ++column) cast_column(column);
#pragma omp parallel for schedule(dynamic, 16)
    for (int column = 0; column < columns; ++column) report_column(column);
    return std::move(image_);
  }

 private:
  std::optional<RayHit> cast(int row, int column, const Eigen::Vector3d& direction) const {
    const int firing = sensor_.firing_column(row, column);
    const Pose& pose = T_world_sensor_[static_cast<std::size_t>(firing)];
    // Windows show what is up to some metres behind them, never what is nearer.
    return scene_.cast(pose.translation(), pose.linear() * direction,
                       (firing + 0.5) / sensor_.columns, 1.1 * sensor_.max_range_m);
  }

  void cast_column(int column) {
    for (int row = 0; row < sensor_.rows(); ++row) {
      const std::size_t pixel = image_.index(row, column);
      const auto hit = cast(row, column, directions_[pixel]);
      central_.met[pixel] = hit ? 1 : 0;
      if (hit) central_.hits[pixel] = *hit;
    }
  }

  void report_column(int column) {
    for (int row = 0; row < sensor_.rows(); ++row) {
      const std::size_t pixel = image_.index(row, column);
      const PixelBits bits = bits_of(row, column);
      const auto echo = reported_echo(footprint(row, column, bits));
      if (echo) {
        image_.range_m[pixel] =
            detected_range_m(*echo, sensor_.min_range_m, sensor_.max_range_m, bits.pixel);
      }
      image_.range_m[pixel] = disturbed_range_m(image_.range_m[pixel], conditions_, sensor_,
                                                seed_of(bits.pixel, kDisturbance));
    }
  }

  PixelBits bits_of(int row, int column) const {
    constexpr int kPatchRows = 3;
    constexpr int kPatchColumns = 5;
    const std::size_t patch = image_.index(row / kPatchRows, column / kPatchColumns);
    return {seed_of(seed_, image_.index(row, column)), seed_of(~seed_, patch)};
  }

  Footprint footprint(int row, int column, const PixelBits& bits) const {
    const std::size_t pixel = image_.index(row, column);
    Footprint footprint;
    const auto add = [&](const RayHit& hit, double weight) {
      const auto echo = echo_of(hit, sensor_.max_range_m, bits);
      if (!echo) return;
      const double left = transmission(conditions_.extinction_per_m, echo->range_m);
      footprint.add({echo->range_m, echo->signal * left}, weight);
    };
    if (central_.met[pixel] != 0) add(central_.hits[pixel], 2.0);
    for (const NeighbourStep& step : kNeighbours) {
      const int other_row = row + step.row;
      if (other_row < 0 || other_row >= sensor_.rows()) continue;
      const int other_column = (column + step.column + sensor_.columns) % sensor_.columns;
      const std::size_t other = image_.index(other_row, other_column);
      if (!jumps(central_, pixel, other)) continue;
      const Eigen::Vector3d towards = directions_[other] - directions_[pixel];
      const auto hit =
          cast(row, column,
               (directions_[pixel] + kHalfDivergence_rad * towards.normalized()).normalized());
      if (hit) add(*hit, 1.0);
    }
    return footprint;
  }

  const SensorModel& sensor_;
  const SensingConditions& conditions_;
  const std::vector<Eigen::Vector3d>& directions_;
  const RayScene& scene_;
  const std::vector<Pose>& T_world_sensor_;
  std::uint64_t seed_;
  CentralRays central_;
  RangeImage image_;
};

}  // namespace

Lidar::Lidar(const SensorModel& sensor, const SensingConditions& conditions, std::uint64_t seed)
    : sensor_(sensor), conditions_(conditions), seed_(seed) {
  for (int row = 0; row < sensor_.rows(); ++row) {
    const double elevation_rad = sensor_.beam_elevation_rad[static_cast<std::size_t>(row)];
    for (int column = 0; column < sensor_.columns; ++column) {
      const double azimuth_rad = sensor_.azimuth_rad(row, column);
      directions_.emplace_back(std::cos(elevation_rad) * std::cos(azimuth_rad),
                               std::cos(elevation_rad) * std::sin(azimuth_rad),
                               std::sin(elevation_rad));
    }
  }
}

RangeImage Lidar::measure(const RayScene& scene, const std::vector<Pose>& T_world_sensor,
                          std::int64_t scan) const {
  return Measurement(sensor_, conditions_, directions_, scene, T_world_sensor,
                     seed_of(seed_, static_cast<std::uint64_t>(scan)))
      .take();
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
