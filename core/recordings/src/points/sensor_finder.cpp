#include "points/sensor_finder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/median.h"
#include "points/beams_in_points.h"
#include "points/ring_numbers.h"

// The beams of a sensor, found in the points of some of its scans.
//
// In:  points in the sensor frame, metres, with the numbers of their rings where the file has them.
// Out: the elevation of each beam (beams_in_points.cpp), highest first; columns.
//
// A sensor is accepted if hardly any point is nearer to another beam than to its own, and if each
// scan alone gives the same beams.

namespace hqslam::recordings {

namespace {

constexpr int kFewestBeams = 4;
constexpr double kMostBetweenBeams = 0.03;
constexpr double kMostContradicting = 0.1;
/// Share of the beams that single scans must have, in the mean.
constexpr double kLeastSeen = 0.7;
/// A beam is a preset's, or that of another scan, within this.
constexpr double kSameBeam_rad = 0.15 * kDegree_rad;
/// A unit's beams are those of its table where half of them are within this; beams that are farther
/// from it than a unit's may be are another sensor's.
constexpr double kFitsTable_rad = 0.1 * kDegree_rad;
constexpr double kFarthestOffTable_rad = 1.5 * kDegree_rad;

constexpr double kDefaultPeriod_s = 0.1;
constexpr int kDefaultColumns = 1024;

/// Distance to the nearer neighbour.
double spacing_rad(const std::vector<Beam>& beams, std::size_t i) {
  double nearest_rad = 2.0 * std::numbers::pi;
  for (const std::size_t j : {i - 1, i + 1}) {  // before the first: beyond the last
    if (j >= beams.size()) continue;
    nearest_rad = std::min(nearest_rad, std::abs(beams[i].elevation_rad - beams[j].elevation_rad));
  }
  return nearest_rad;
}

/// Why these beams cannot be a sensor's; "" if they can.
std::string complaint(const Beams& found, std::size_t scans) {
  const std::vector<Beam>& beams = found.beams;
  if (beams.size() < kFewestBeams || beams.size() > kMostBeams) {
    return fmt::format("found {} beams that are clearly apart", beams.size());
  }
  double points = found.strays, between = found.strays, seen = 0.0, contradicting = 0.0;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const double apart_rad = spacing_rad(beams, i);
    std::vector<std::vector<double>> off_rad(scans);
    for (const Sight& sight : beams[i].sights) {
      off_rad[sight.scan].push_back(beams[i].off_rad(sight));
      points += 1.0;
      between += std::abs(off_rad[sight.scan].back()) > found.nearest * apart_rad ? 1.0 : 0.0;
    }
    for (std::vector<double>& off : off_rad) {
      if (off.size() < kFewestPoints) continue;
      seen += 1.0;
      contradicting += std::abs(median(off)) > std::min(apart_rad / 4.0, kSameBeam_rad) ? 1.0 : 0.0;
    }
  }
  if (between > kMostBetweenBeams * points) {
    return fmt::format(
        "found {} beams, but {:.0f} % of the points between them, as in clouds that were tilted, "
        "moved or merged after the sensor measured them",
        beams.size(), 100.0 * between / points);
  }
  if (seen < kLeastSeen * static_cast<double>(beams.size() * scans)) {
    return fmt::format("found {} beams, of which single scans have {:.0f} %", beams.size(),
                       100.0 * seen / static_cast<double>(beams.size() * scans));
  }
  if (contradicting <= kMostContradicting * seen) return "";
  return fmt::format("found {} beams, {:.0f} % of which look elsewhere in single scans",
                     beams.size(), 100.0 * contradicting / seen);
}

/// From the step of the azimuth from point to point of a beam.
int columns_of(const std::vector<Beam>& beams) {
  std::vector<double> steps_rad;
  for (const Beam& beam : beams) {
    std::vector<std::pair<std::size_t, double>> ways;
    for (const Sight& sight : beam.sights) ways.emplace_back(sight.scan, sight.azimuth_rad);
    std::ranges::sort(ways);
    for (std::size_t i = 1; i < ways.size(); ++i) {
      const double step_rad = ways[i].second - ways[i - 1].second;
      if (ways[i].first == ways[i - 1].first && step_rad > 1e-5) steps_rad.push_back(step_rad);
    }
  }
  if (steps_rad.empty()) return kDefaultColumns;
  // Where nothing came back, steps are longer.
  const double short_rad = quantile(steps_rad, 0.3);
  std::erase_if(steps_rad, [&](double step) { return std::abs(step / short_rad - 1.0) > 0.5; });
  const double columns = 2.0 * std::numbers::pi / median(steps_rad);
  for (const int usual : {512, 1024, 2048, 4096}) {
    if (std::abs(columns / usual - 1.0) < 0.015) return usual;
  }
  if (!(columns > 200.0 && columns < 4500.0)) return kDefaultColumns;
  const int step = columns < 1000.0 ? 10 : 100;
  return static_cast<int>(std::lround(columns / step)) * step;
}

/// How far the beams are from the nearest ones of a sensor, at most. Nothing if those are too few
/// for them, or two are the same one.
std::optional<double> farthest_off_rad(const SensorModel& sensor, const std::vector<Beam>& beams) {
  const auto& rows_rad = sensor.beam_elevation_rad;
  if (beams.size() > rows_rad.size()) return std::nullopt;
  double most_rad = 0.0;
  std::size_t row = 0;
  for (const Beam& beam : beams) {
    const auto off_rad = [&](std::size_t r) { return std::abs(beam.elevation_rad - rows_rad[r]); };
    while (row + 1 < rows_rad.size() && off_rad(row + 1) < off_rad(row)) ++row;
    if (row == rows_rad.size()) return std::nullopt;
    most_rad = std::max(most_rad, off_rad(row++));
  }
  return most_rad;
}

/// The preset that has these beams, and a few more at most of which nothing came back; else one
/// with these beams alone.
FoundSensor sensor_with(const std::vector<Beam>& beams) {
  const int columns = columns_of(beams);
  for (const std::string& name : sensor_preset_names()) {
    SensorModel preset = sensor_preset(name);
    const auto off_rad = farthest_off_rad(preset, beams);
    if (!off_rad || *off_rad > kSameBeam_rad || 4 * std::ssize(beams) < 3 * preset.rows()) continue;
    // A sensor that turns faster has fewer columns than its preset; more are not used.
    if (columns < preset.columns * 3 / 4) preset.columns = columns;
    return {
        preset, {}, fmt::format("those of {} within {:.3f} degrees", name, *off_rad / kDegree_rad)};
  }
  SensorModel sensor;
  sensor.name = fmt::format("found-{}", beams.size());
  sensor.columns = columns;
  sensor.min_range_m = 0.5;
  sensor.max_range_m = 200.0;
  for (const Beam& beam : beams) sensor.beam_elevation_rad.push_back(beam.elevation_rad);
  sensor.beam_azimuth_offset_rad.assign(beams.size(), 0.0);
  return {sensor, {}, "those of no preset"};
}

struct Way {
  const char* name;
  Beams (*find)(const std::vector<RawPoints>& scans);
};
constexpr std::array<Way, 3> kWays = {{{"rings", beams_by_rings},
                                       {"the order of points", beams_by_order},
                                       {"elevations", beams_by_elevation}}};

/// Whether the beams that were found are others than the sensor's, and less than half as many
/// between the highest and the lowest of them: taken for the sensor's, their points would get wrong
/// rows.
bool has_few_beams(const SensorModel& found, const SensorModel& taken_for) {
  const std::vector<double>& found_rad = found.beam_elevation_rad;
  const std::vector<double>& rows_rad = taken_for.beam_elevation_rad;
  const auto between = std::ranges::count_if(rows_rad, [&](double row_rad) {
    return row_rad <= found_rad.front() && row_rad >= found_rad.back();
  });
  const auto is_a_row = [&](double beam_rad) {
    return std::ranges::any_of(
        rows_rad, [&](double row_rad) { return std::abs(row_rad - beam_rad) < kSameBeam_rad; });
  };
  return 2 * std::ssize(found_rad) < between && !std::ranges::all_of(found_rad, is_a_row);
}

/// The scans that have numbers of rings, or those that have none, whichever are more.
std::vector<RawPoints> of_one_kind(std::vector<RawPoints> scans) {
  const auto has_rings = [](const RawPoints& raw) { return !raw.ring.empty(); };
  const bool most = 2 * std::ranges::count_if(scans, has_rings) >= std::ssize(scans);
  std::erase_if(scans, [&](const RawPoints& raw) { return has_rings(raw) != most; });
  return scans;
}

/// Nothing where the points do not determine a sensor: `wrong` has the reason.
std::optional<FoundSensor> sensor_in(const std::vector<RawPoints>& scans,
                                     std::optional<double> scan_period_s, std::string& wrong) {
  wrong = "found no points";
  for (const Way& way : kWays) {
    if (scans.empty()) break;
    const Beams found_beams = way.find(scans);
    wrong = complaint(found_beams, scans.size());
    const bool has_rings = found_beams.rings >= kFewestBeams;
    if (!wrong.empty() && has_rings) break;
    if (!wrong.empty()) continue;
    const std::vector<Beam>& beams = found_beams.beams;
    FoundSensor found = sensor_with(beams);
    if (found.sensor.rows() < found_beams.rings) {
      wrong = fmt::format("found points of {} of {} rings", beams.size(), found_beams.rings);
      break;
    }
    for (const Beam& beam : beams) found.beam_elevation_rad.push_back(beam.elevation_rad);
    found.sensor.scan_period_s = scan_period_s.value_or(kDefaultPeriod_s);
    validate(found.sensor);
    found.note = fmt::format(
        "sensor found in the points: {} beams from {:.2f} to {:.2f} degrees, by {} of {} scan{}, "
        "{}; name the sensor if it is another one",
        beams.size(), beams.front().elevation_rad / kDegree_rad,
        beams.back().elevation_rad / kDegree_rad, way.name, scans.size(),
        scans.size() == 1 ? "" : "s", found.note);
    return found;
  }
  return std::nullopt;
}

}  // namespace

FoundSensor find_sensor(const std::vector<RawPoints>& all, std::optional<double> scan_period_s,
                        const std::string& source) {
  constexpr std::size_t kFewestScans = 4;
  std::vector<RawPoints> scans = of_one_kind(all);
  std::string wrong, ignored;
  auto found = sensor_in(scans, scan_period_s, wrong);
  for (std::size_t odd = 0; !found && scans.size() >= kFewestScans && odd < scans.size(); ++odd) {
    std::vector<RawPoints> others = scans;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(odd));
    found = sensor_in(others, scan_period_s, ignored);
  }
  if (found) return std::move(*found);
  throw Error(
      "{}: cannot determine the sensor from the recording or its points: {}; give --sensor NAME or "
      "--sensor FILE.json",
      source, wrong);
}

std::optional<FoundSensor> found_if_any(const std::function<FoundSensor()>& find) {
  try {
    return find();
  } catch (const Error&) {
    return std::nullopt;
  }
}

FoundSensor held_against_points(const SensorModel& stated, const std::optional<FoundSensor>& found,
                                const std::string& source) {
  FoundSensor result{stated, {}, "", false};
  if (!found) return result;
  result.beam_elevation_rad = found->beam_elevation_rad;
  const SensorModel& other = found->sensor;
  const auto presets = sensor_preset_names();
  const bool is_other_preset = std::ranges::find(presets, other.name) != presets.end() &&
                               other.rows() == stated.rows() && !have_same_beams(other, stated);
  if (is_other_preset || has_few_beams(other, stated)) {
    throw Error(
        "{}: expected scans of '{}' with {} rows, found beams of '{}' with {}; name the sensor "
        "that recorded them",
        source, stated.name, stated.rows(), other.name, other.rows());
  }
  if (const auto rows = rows_with_beams(stated, found->beam_elevation_rad)) {
    result.sensor = select_rows(stated, *rows);
    result.note = selection_text(stated.rows(), *rows);
  }
  return result;
}

std::optional<SensorModel> with_own_beams(const SensorModel& sensor,
                                          const std::vector<double>& found_rad) {
  const std::vector<double>& table_rad = sensor.beam_elevation_rad;
  if (found_rad.size() != table_rad.size()) return std::nullopt;
  std::vector<double> off_rad;
  for (std::size_t row = 0; row < table_rad.size(); ++row) {
    off_rad.push_back(std::abs(found_rad[row] - table_rad[row]));
  }
  const bool is_this_kind = *std::ranges::max_element(off_rad) <= kFarthestOffTable_rad;
  if (!is_this_kind || median(off_rad) < kFitsTable_rad) return std::nullopt;
  SensorModel own = sensor;
  own.beam_elevation_rad = found_rad;
  return own;
}

}  // namespace hqslam::recordings
