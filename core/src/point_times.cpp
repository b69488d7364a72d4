#include "hqslam/core/point_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hqslam/core/error.h"

namespace hqslam {

namespace {

struct Unit {
  double s;
  const char* name;
};
constexpr std::array<Unit, 4> kFractions = {
    {{1.0, "seconds"}, {1e-9, "nanoseconds"}, {1e-6, "microseconds"}, {1e-3, "milliseconds"}}};
constexpr std::array<Unit, 4> kWholeNumbers = {
    {{1e-9, "nanoseconds"}, {1e-6, "microseconds"}, {1e-3, "milliseconds"}, {1.0, "seconds"}}};
constexpr double kShortestInTurns = 0.01;
constexpr double kLongestInTurns = 1.25;
/// Times of a scan's own count from near 0; those of a clock that was set, from 1970.
constexpr double kSmallestClock_s = 1e6;
/// Rings in the order of the beams correlate with the elevation by more than 0.95; in the order of
/// firing by less than 0.6.
constexpr double kMinRingCorrelation = 0.8;
/// A unit's beams are off its data sheet by less than this.
constexpr double kFarthestOff_rad = 2.0 * std::numbers::pi / 180.0;
constexpr std::size_t kFewestPointsToJudge = 1000;

double elevation_rad(const Eigen::Vector3f& point_m) {
  return std::atan2(point_m.z(), point_m.head<2>().norm());
}

/// Pearson's correlation of ring number and elevation; 0 where one of them does not vary.
double correlation_with_elevation(const std::vector<double>& ring, const Scan& scan) {
  double sum_r = 0.0, sum_e = 0.0, sum_rr = 0.0, sum_ee = 0.0, sum_re = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const double elevation = elevation_rad(scan.points_m[i]);
    sum_r += ring[i];
    sum_e += elevation;
    sum_rr += ring[i] * ring[i];
    sum_ee += elevation * elevation;
    sum_re += ring[i] * elevation;
  }
  const double n = static_cast<double>(ring.size());
  const double variance_r = sum_rr - sum_r * sum_r / n;
  const double variance_e = sum_ee - sum_e * sum_e / n;
  if (!(variance_r > 1e-9 * n) || !(variance_e > 1e-12 * n)) return 0.0;
  return (sum_re - sum_r * sum_e / n) / std::sqrt(variance_r * variance_e);
}

/// The rings of a sensor with fewer of them, counted as this one's, would all be in wrong rows.
void require_rings_of(const SensorModel& sensor, const std::vector<std::uint16_t>& rows,
                      const Scan& scan, const std::string& source, const std::string& field) {
  std::vector<bool> used(sensor.rows());
  for (const std::uint16_t row : rows) used[row] = true;
  const auto rings = std::count(used.begin(), used.end(), true);
  if (rows.size() < kFewestPointsToJudge || 2 * rings > sensor.rows()) return;
  std::size_t off = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double beam_rad = sensor.beam_elevation_rad[rows[i]];
    if (std::abs(elevation_rad(scan.points_m[i]) - beam_rad) > kFarthestOff_rad) ++off;
  }
  if (2 * off <= rows.size()) return;
  throw Error(
      fmt::format("{}: field '{}': expected the rings of sensor '{}' with {} rows, found {} rings, "
                  "{:.0f} % of their points off its beams; name the sensor that recorded the scan",
                  source, field, sensor.name, sensor.rows(), rings,
                  100.0 * static_cast<double>(off) / static_cast<double>(rows.size())));
}

}  // namespace

std::optional<PointTimes> point_times(const PointTimeField& field, double scan_period_s,
                                      const std::string& source) {
  if (field.values.empty()) return std::nullopt;
  const bool finite = std::all_of(field.values.begin(), field.values.end(),
                                  [](double t) { return std::isfinite(t); });
  const auto [first, last] = std::minmax_element(field.values.begin(), field.values.end());
  if (finite && *first == *last) return std::nullopt;
  const double span = *last - *first;
  const auto& units = field.whole_numbers ? kWholeNumbers : kFractions;
  const auto turns = [&](const Unit& candidate) { return span * candidate.s / scan_period_s; };
  auto unit = std::find_if(units.begin(), units.end(), [&](const Unit& candidate) {
    return turns(candidate) > kShortestInTurns && turns(candidate) < kLongestInTurns;
  });
  // A handful of points, all from one moment of the turn, last less in any unit.
  if (unit == units.end() && turns(units.front()) < kLongestInTurns) unit = units.begin();
  if (!finite || unit == units.end()) {
    throw Error(fmt::format(
        "{}: field '{}': expected times of one scan, a turn of {:.4g} s, found {}; give the times "
        "in {}, a sensor file with the right scan_period_s, or leave the field out",
        source, field.name, scan_period_s,
        finite ? fmt::format("a scan of {:.6g} s", span * units.front().s)
               : std::string("a time that is not finite"),
        units.front().name));
  }
  PointTimes times;
  const double middle = *first + span / 2.0;
  times.middle_s = middle * unit->s;
  times.absolute = std::abs(times.middle_s) > kSmallestClock_s;
  times.offset_s.reserve(field.values.size());
  for (const double t : field.values) {
    times.offset_s.push_back(static_cast<float>((t - middle) * unit->s));
  }
  return times;
}

std::vector<std::uint16_t> rows_from_rings(const std::vector<double>& ring, const Scan& scan,
                                           const SensorModel& sensor, const std::string& source,
                                           const std::string& field) {
  const double last_ring = sensor.rows() - 1;
  for (const double r : ring) {
    if (!(r >= 0.0 && r <= last_ring) || r != std::floor(r)) {
      throw Error(
          fmt::format("{}: field '{}': expected 0 to {} for sensor '{}', found {}; name the sensor "
                      "that recorded the scan",
                      source, field, last_ring, sensor.name, r));
    }
  }
  const double correlation = correlation_with_elevation(ring, scan);
  if (std::abs(correlation) < kMinRingCorrelation) return {};
  std::vector<std::uint16_t> rows;
  rows.reserve(ring.size());
  for (const double r : ring) {
    rows.push_back(static_cast<std::uint16_t>(correlation < 0.0 ? r : last_ring - r));
  }
  require_rings_of(sensor, rows, scan, source, field);
  return rows;
}

}  // namespace hqslam
