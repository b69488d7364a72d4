#include "foreign_map/virtual_scan.h"

#include <algorithm>
#include <cmath>

#include "hqslam/core/angles.h"
#include "hqslam/slam/scan_context.h"

namespace hqslam::slam {

namespace {

constexpr double kFineWithin_m = 25.0;

}  // namespace

SensorModel virtual_sensor(const SensorModel& sensor) {
  constexpr int kRows = 64;
  constexpr int kColumns = 1024;
  SensorModel result;
  result.name = "virtual";
  result.columns = std::max(sensor.columns, kColumns);
  result.scan_period_s = sensor.scan_period_s;
  result.min_range_m = sensor.min_range_m;
  result.max_range_m = std::min(sensor.max_range_m, ScanContext::kMaxRange_m);
  result.motion_corrected = true;
  const int rows = std::max(sensor.rows(), kRows);
  const double highest_rad = sensor.beam_elevation_rad.front();
  const double lowest_rad = sensor.beam_elevation_rad.back();
  for (int row = 0; row < rows; ++row) {
    result.beam_elevation_rad.push_back(highest_rad +
                                        (lowest_rad - highest_rad) * row / (rows - 1));
  }
  result.beam_azimuth_offset_rad.assign(static_cast<std::size_t>(rows), 0.0);
  return result;
}

VirtualScanner::VirtualScanner(const SensorModel& sensor, const SurfelTiles& fine,
                               const SurfelTiles& coarse)
    : sensor_(sensor), fine_(fine), coarse_(coarse) {
  for (int row = 0; row < sensor.rows(); ++row) {
    const double elevation_rad = sensor.beam_elevation_rad[static_cast<std::size_t>(row)];
    for (int column = 0; column < sensor.columns; ++column) {
      const double azimuth_rad = sensor.azimuth_rad(row, column);
      const Eigen::Vector3d beam = direction_of(azimuth_rad, elevation_rad);
      beams_.push_back(beam.cast<float>());
    }
  }
}

OrganizedCloud VirtualScanner::scan(const Pose& T_map_sensor) const {
  OrganizedCloud cloud(sensor_.rows(), sensor_.columns);
  const Eigen::Isometry3f T_sensor_map = T_map_sensor.inverse().cast<float>();
  const auto draw_all = [&](const SurfelTiles& tiles, double from_m, double to_m) {
    tiles.for_each_near(T_map_sensor.translation(), to_m, [&](Surfel surfel) {
      surfel.point_m = T_sensor_map * surfel.point_m;
      const double range_m = surfel.point_m.norm();
      if (range_m <= from_m || range_m > to_m) return;
      surfel.normal = T_sensor_map.linear() * surfel.normal;
      draw(surfel, cloud);
    });
  };
  draw_all(fine_, sensor_.min_range_m, kFineWithin_m);
  draw_all(coarse_, kFineWithin_m, sensor_.max_range_m);
  for (std::size_t pixel = 0; pixel < beams_.size(); ++pixel) {
    cloud.points_m[pixel] = cloud.range_m[pixel] * beams_[pixel];
  }
  return cloud;
}

OrganizedCloud with_rows_of(const SensorModel& sensor, const OrganizedCloud& scan,
                            const SensorModel& seen_by) {
  const auto& rows = seen_by.beam_elevation_rad;
  const double step_rad = (rows.front() - rows.back()) / (seen_by.rows() - 1);
  OrganizedCloud result(sensor.rows(), scan.columns);
  for (int row = 0; row < sensor.rows(); ++row) {
    const double elevation_rad = sensor.beam_elevation_rad[static_cast<std::size_t>(row)];
    const long nearest = std::lround((rows.front() - elevation_rad) / step_rad);
    const std::size_t from = scan.index(static_cast<int>(nearest), 0);
    const std::size_t to = result.index(row, 0);
    for (std::size_t column = 0; column < static_cast<std::size_t>(scan.columns); ++column) {
      result.points_m[to + column] = scan.points_m[from + column];
      result.range_m[to + column] = scan.range_m[from + column];
    }
  }
  return result;
}

/// In: a surfel in the sensor's frame.
void VirtualScanner::draw(const Surfel& surfel, OrganizedCloud& cloud) const {
  const float range_m = surfel.point_m.norm();
  const double reach_rad = surfel.radius_m / range_m;
  const double elevation_rad = std::asin(surfel.point_m.z() / range_m);
  const auto& rows = sensor_.beam_elevation_rad;  // falling
  const auto from = std::ranges::lower_bound(rows, elevation_rad + reach_rad, std::greater<>());
  const int middle = sensor_.column_of_azimuth(std::atan2(surfel.point_m.y(), surfel.point_m.x()));
  const double level_rad = reach_rad / std::max(std::cos(elevation_rad), 0.1);
  const int side = std::min(static_cast<int>(std::ceil(level_rad / sensor_.column_step_rad())),
                            sensor_.columns / 2 - 1);
  const float square_m2 = surfel.radius_m * surfel.radius_m;
  for (auto row = from; row != rows.end() && *row >= elevation_rad - reach_rad; ++row) {
    for (int column = middle - side; column <= middle + side; ++column) {
      const int wrapped = (column + sensor_.columns) % sensor_.columns;
      const std::size_t pixel = cloud.index(static_cast<int>(row - rows.begin()), wrapped);
      const Eigen::Vector3f& beam = beams_[pixel];
      const float across = surfel.normal.dot(beam);
      const float to_plane_m =
          across == 0.0F ? range_m : surfel.normal.dot(surfel.point_m) / across;
      if ((to_plane_m * beam - surfel.point_m).squaredNorm() > square_m2) continue;
      float& nearest_m = cloud.range_m[pixel];
      if (nearest_m == 0.0F || to_plane_m < nearest_m) nearest_m = to_plane_m;
    }
  }
}

}  // namespace hqslam::slam
