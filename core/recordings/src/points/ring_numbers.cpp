#include "points/ring_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/median.h"

namespace hqslam::recordings {

namespace {

constexpr std::size_t kFewestRows = 4;
/// A beam is a row's within this, as in sensor_finder.cpp.
constexpr double kBeamOfRow_rad = radians(0.15);
/// No driver numbers rings beyond.
constexpr double kMostNumber = 1024.0;

std::vector<int> numbers_in(const std::vector<RawPoints>& scans) {
  std::set<int> numbers;
  for (const RawPoints& points : scans) {
    for (const double ring : points.ring) {
      if (!(ring >= 0.0 && ring < kMostNumber) || ring != std::floor(ring)) return {};
      numbers.insert(static_cast<int>(ring));
    }
  }
  return {numbers.begin(), numbers.end()};
}

/// Median distance of the points from the beams of the rows that their rings give.
double off_beams_rad(const RawPoints& points, const SensorModel& sensor, RingNumbers numbers) {
  std::vector<double> rings = points.ring;
  numbers.count_from_0(rings);
  std::vector<double> off_rad;
  try {
    const auto rows = rows_from_rings(rings, points.scan, sensor, "", "");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Eigen::Vector3f& p = points.scan.points_m[i];
      off_rad.push_back(std::abs(std::atan2(double{p.z()}, double{p.head<2>().norm()}) -
                                 sensor.beam_elevation_rad[rows[i]]));
    }
  } catch (const Error&) {
    off_rad.clear();  // not this sensor's
  }
  return off_rad.empty() ? std::numeric_limits<double>::infinity() : median(std::move(off_rad));
}

}  // namespace

RingNumbers RingNumbers::of(const std::vector<int>& numbers) {
  RingNumbers result{numbers.front(), 0};
  for (const int number : numbers) result.step = std::gcd(result.step, number - result.first);
  result.step = std::max(result.step, 1);
  return result;
}

void RingNumbers::count_from_0(std::vector<double>& rings) const {
  for (double& ring : rings) ring = (ring - first) / step;
}

RingNumbers ring_numbers(const std::vector<RawPoints>& scans, const SensorModel& sensor) {
  const std::vector<int> numbers = numbers_in(scans);
  if (numbers.empty() || numbers.back() < sensor.rows()) return {};
  const RingNumbers found = RingNumbers::of(numbers);
  const int unseen = sensor.rows() - 1 - (numbers.back() - numbers.front()) / found.step;
  RingNumbers best;
  double least_rad = std::numeric_limits<double>::infinity();
  for (int before = 0; before <= unseen; ++before) {
    const RingNumbers candidate{found.first - before * found.step, found.step};
    const double off_rad = off_beams_rad(scans.front(), sensor, candidate);
    if (off_rad < least_rad || before == 0) best = candidate;
    least_rad = std::min(least_rad, off_rad);
  }
  return best;
}

std::optional<RowSelection> selection_of(const std::vector<int>& rows) {
  if (rows.size() < kFewestRows) return std::nullopt;
  const RingNumbers numbers = RingNumbers::of(rows);
  if (numbers.step == 1) return std::nullopt;
  return RowSelection{numbers.first % numbers.step, numbers.step};
}

std::optional<RowSelection> rows_with_beams(const SensorModel& sensor,
                                            const std::vector<double>& beams_rad) {
  std::vector<int> rows;
  for (int row = 0; row < sensor.rows(); ++row) {
    const auto is_here = [&](double beam_rad) {
      return std::abs(beam_rad - sensor.beam_elevation_rad[row]) < kBeamOfRow_rad;
    };
    if (std::ranges::any_of(beams_rad, is_here)) rows.push_back(row);
  }
  return rows.size() == beams_rad.size() ? selection_of(rows) : std::nullopt;
}

std::string selection_text(int rows, RowSelection selection) {
  const std::vector<int> kept = selected_rows(rows, selection);
  return fmt::format(
      "only rows {}, {}, ... {} of {} hold points: read as a sensor of these {} rows", kept[0],
      kept[1], kept.back(), rows, kept.size());
}

}  // namespace hqslam::recordings
