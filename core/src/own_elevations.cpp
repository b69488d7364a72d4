#include "own_elevations.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ring_segments.h"

namespace hqslam {

namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr double kFits_rad = 0.1 * kDegree_rad;
constexpr double kFarthest_rad = 1.5 * kDegree_rad;
constexpr std::size_t kFewestPoints = 100;

/// How far each row is from the table, where it has points enough.
std::vector<std::optional<double>> deviations_rad(const SensorModel& sensor,
                                                  const std::vector<Scan>& scans) {
  std::vector<std::vector<double>> elevations(static_cast<std::size_t>(sensor.rows()));
  for (const Scan& scan : scans) {
    for (std::size_t i = 0; i < scan.row.size(); ++i) {
      const Eigen::Vector3f& point_m = scan.points_m[i];
      const float range_m = point_m.norm();
      if (!(range_m >= sensor.min_range_m && range_m <= sensor.max_range_m)) continue;
      elevations[scan.row[i]].push_back(
          std::atan2(double{point_m.z()}, double{point_m.head<2>().norm()}));
    }
  }
  std::vector<std::optional<double>> result(elevations.size());
  for (std::size_t row = 0; row < elevations.size(); ++row) {
    if (elevations[row].size() < kFewestPoints) continue;
    result[row] = median(elevations[row]) - sensor.beam_elevation_rad[row];
  }
  return result;
}

/// The deviation of the nearest row that has one.
double nearest(const std::vector<std::optional<double>>& deviations, std::size_t row) {
  for (std::size_t away = 0; away < deviations.size(); ++away) {
    if (row >= away && deviations[row - away]) return *deviations[row - away];
    if (row + away < deviations.size() && deviations[row + away]) return *deviations[row + away];
  }
  return 0.0;
}

}  // namespace

std::optional<SensorModel> with_own_elevations(const SensorModel& sensor,
                                               const std::vector<Scan>& scans) {
  const auto deviations = deviations_rad(sensor, scans);
  std::vector<double> known;
  for (const auto& deviation : deviations) {
    if (deviation) known.push_back(std::abs(*deviation));
  }
  if (known.size() < 2 || *std::max_element(known.begin(), known.end()) > kFarthest_rad ||
      median(known) < kFits_rad) {
    return std::nullopt;
  }
  SensorModel own = sensor;
  for (std::size_t row = 0; row < deviations.size(); ++row) {
    own.beam_elevation_rad[row] += nearest(deviations, row);
    if (row > 0 && own.beam_elevation_rad[row] >= own.beam_elevation_rad[row - 1]) {
      return std::nullopt;
    }
  }
  return own;
}

}  // namespace hqslam
