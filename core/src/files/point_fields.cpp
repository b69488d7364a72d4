#include "hqslam/core/point_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"
#include "scan/row_correlation.h"

namespace hqslam {

namespace {

/// No LiDAR takes longer for one scan.
constexpr double kMaxScanDuration_s = 1.0;

/// Beyond this the stamp of a message and the clock of its points' times are not one clock.
constexpr double kMostClocksApart_s = 2.0;

/// "timeStamp" and "time_stamp" are one name, and so are "x" and "X (m)", "ring" and CloudCompare's
/// "scalar_ring".
std::string plain(std::string_view name) {
  if (name.starts_with("scalar_")) name.remove_prefix(7);
  std::string result;
  for (const char c : name.substr(0, name.find('('))) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return result;
}

/// The first of the names that is there; nullptr: none is.
const PointField* field_of(const std::vector<PointField>& fields,
                           std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) {
    for (const PointField& field : fields) {
      if (plain(field.name) == name) return &field;
    }
  }
  return nullptr;
}

struct Unit {
  double s;
  const char* name;
};
constexpr std::array<Unit, 4> kFractions = {
    {{1.0, "seconds"}, {1e-9, "nanoseconds"}, {1e-6, "microseconds"}, {1e-3, "milliseconds"}}};
constexpr std::array<Unit, 4> kWholeNumbers = {
    {{1e-9, "nanoseconds"}, {1e-6, "microseconds"}, {1e-3, "milliseconds"}, {1.0, "seconds"}}};
/// Less, and a leap of a clock by a second would pass for a turn in milliseconds.
constexpr double kShortestInTurns = 0.05;
constexpr double kLongestInTurns = 1.25;
/// Times of a scan's own count from near 0. Larger ones are a clock's even in a single scan.
constexpr double kSmallestClock_s = 1e6;
/// Rings in the order of the beams correlate with the elevation by more than 0.95; in the order of
/// firing by less than 0.6.
constexpr double kMinRingCorrelation = 0.8;
/// A unit's beams are off its data sheet by less than this.
constexpr double kFarthestOff_rad = 2.0 * std::numbers::pi / 180.0;
constexpr std::size_t kFewestPointsToJudge = 1000;

/// Times that at most this share of the points has, and that are farther from all others than this
/// share of the time that those last, are not of the scan: they wrapped below 0 (ouster-ros issue
/// 46) or are of the turn before.
constexpr double kWildShare = 0.005;
constexpr double kWildDistance = 0.25;

double elevation_rad(const Eigen::Vector3f& point_m) {
  return std::atan2(point_m.z(), point_m.head<2>().norm());
}

/// The rings of a sensor with fewer of them, counted as this one's, would all be in wrong rows.
void require_rings_of(const SensorModel& sensor, const std::vector<std::uint16_t>& rows,
                      const Scan& scan, const std::string& source, const std::string& field) {
  std::vector<bool> used(sensor.rows());
  for (const std::uint16_t row : rows) used[row] = true;
  const auto rings = std::ranges::count(used, true);
  if (rows.size() < kFewestPointsToJudge || 2 * rings > sensor.rows()) return;
  std::size_t off = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double beam_rad = sensor.beam_elevation_rad[rows[i]];
    if (std::abs(elevation_rad(scan.points_m[i]) - beam_rad) > kFarthestOff_rad) ++off;
  }
  if (2 * off <= rows.size()) return;
  throw Error(
      "{}: field '{}': expected the rings of sensor '{}' with {} rows, found {} rings, {:.0f} % of "
      "their points off its beams; name the sensor that recorded the scan",
      source, field, sensor.name, sensor.rows(), rings,
      100.0 * static_cast<double>(off) / static_cast<double>(rows.size()));
}

/// The earliest and the latest of the times, without those that are wild.
std::pair<double, double> usual_span(const std::vector<double>& values) {
  const auto [first, last] = std::ranges::minmax_element(values);
  const auto few = static_cast<std::ptrdiff_t>(kWildShare * static_cast<double>(values.size()));
  if (few == 0) return {*first, *last};
  std::vector<double> sorted = values;
  std::ranges::nth_element(sorted, sorted.begin() + few);
  const double early = sorted[few];
  std::ranges::nth_element(sorted, sorted.end() - 1 - few);
  const double late = *(sorted.end() - 1 - few);
  const double farthest = kWildDistance * (late - early);
  if (*first >= early - farthest && *last <= late + farthest) return {*first, *last};
  std::pair span(early, late);
  for (const double t : values) {
    if (t < early - farthest || t > late + farthest) continue;
    span = {std::min(span.first, t), std::max(span.second, t)};
  }
  return span;
}

/// The first unit, in the order of preference, in which `span` is one turn; nullptr: none is.
const Unit* unit_of(const PointTimeField& field, double span, double scan_period_s) {
  const auto& units = field.whole_numbers ? kWholeNumbers : kFractions;
  const auto turns = [&](const Unit& candidate) { return span * candidate.s / scan_period_s; };
  const auto* unit = std::ranges::find_if(units, [&](const Unit& candidate) {
    return turns(candidate) > kShortestInTurns && turns(candidate) < kLongestInTurns;
  });
  // A handful of points, all from one moment of the turn, last less in any unit.
  if (unit == units.end() && turns(units.front()) < kLongestInTurns) unit = units.begin();
  return unit == units.end() ? nullptr : unit;
}

template <typename Value>
void erase_marked(std::vector<Value>& values, const std::vector<bool>& marked) {
  if (values.empty()) return;
  std::size_t i = 0;
  std::erase_if(values, [&](const Value&) { return marked[i++]; });
}

/// Points with implausible times count as invalid.
void leave_out_points_without_time(RawPoints& points) {
  Scan& scan = points.scan;
  std::vector<bool> wild;
  for (const float offset_s : scan.time_offset_s) wild.push_back(std::isnan(offset_s));
  const auto count = std::ranges::count(wild, true);
  if (count == 0) return;
  scan.invalid_points += count;
  erase_marked(scan.points_m, wild);
  erase_marked(scan.time_offset_s, wild);
  erase_marked(scan.intensity, wild);
  erase_marked(scan.confidence, wild);
  erase_marked(points.ring, wild);
}

}  // namespace

PointFields point_fields(const std::vector<PointField>& fields, const std::string& source,
                         const char* kind) {
  const PointFields found = {
      field_of(fields, {"x", "pointsmxyz0"}),  // VeloView's, of its tables
      field_of(fields, {"y", "pointsmxyz1"}),
      field_of(fields, {"z", "pointsmxyz2"}),
      field_of(fields, {"ring", "channel", "line", "laserid", "ringid", "beam", "row"}),
      field_of(fields, {"t", "time", "timestamp", "offsettime", "timeoffset", "toffset",
                        "relativetime", "gpstime"}),
      field_of(fields, {"reflectivity", "intensity"}),
      field_of(fields, {"confidence"})};
  if (found.x == nullptr || found.y == nullptr || found.z == nullptr) {
    std::string names;
    for (const PointField& field : fields) names += (names.empty() ? "" : " ") + field.name;
    throw Error("{}: expected {} x y z, found {}; give a point cloud with coordinates", source,
                kind, excerpt(names, 200));
  }
  return found;
}

RawPoints::RawPoints(const PointFields& fields, std::size_t points) {
  if (fields.ring != nullptr) ring_name = fields.ring->name;
  if (fields.time != nullptr) {
    time.name = fields.time->name;
    time.whole_numbers = fields.time->stored.type != 'F';
  }
  scan.points_m.reserve(points);
}

bool RawPoints::add(double x_m, double y_m, double z_m) {
  const Eigen::Vector3f point_m(static_cast<float>(x_m), static_cast<float>(y_m),
                                static_cast<float>(z_m));
  if (!point_m.allFinite() || point_m.isZero(0.0F)) {
    ++scan.invalid_points;
    return false;
  }
  scan.points_m.push_back(point_m);
  return true;
}

Scan scan_of(RawPoints points, const SensorModel* sensor, const std::string& source,
             std::optional<double> stamp_s) {
  Scan& scan = points.scan;
  const double period_s = sensor != nullptr ? sensor->scan_period_s : kMaxScanDuration_s;
  scan.stamp_s = stamp_s.value_or(0.0);
  if (auto times = point_times(points.time, period_s, source)) {
    scan.time_offset_s = std::move(times->offset_s);
    const bool same_clock = !stamp_s || std::abs(times->middle_s - *stamp_s) < kMostClocksApart_s;
    if (times->absolute && same_clock) {
      scan.stamp_s = times->middle_s;
    } else if (times->absolute) {
      scan.stamp_s += times->duration_s / 2.0;
    } else if (stamp_s) {
      scan.stamp_s += times->middle_s;
    }
  }
  leave_out_points_without_time(points);
  if (sensor != nullptr && !points.ring.empty()) {
    scan.row = rows_from_rings(points.ring, scan, *sensor, source, points.ring_name);
  }
  return std::move(scan);
}

std::optional<PointTimes> point_times(const PointTimeField& field, double scan_period_s,
                                      const std::string& source) {
  if (field.values.empty()) return std::nullopt;
  const bool finite = std::ranges::all_of(field.values, [](double t) { return std::isfinite(t); });
  const auto [first, last] = finite ? usual_span(field.values) : std::pair(0.0, 0.0);
  if (finite && first == last) return std::nullopt;
  const Unit* const unit = unit_of(field, last - first, scan_period_s);
  if (!finite || unit == nullptr) {
    const Unit& usual = (field.whole_numbers ? kWholeNumbers : kFractions).front();
    throw Error(
        "{}: field '{}': expected times of one scan, a turn of {:.4g} s, found {}; give the times "
        "in {}, a sensor file with the right scan_period_s, or leave the field out",
        source, field.name, scan_period_s,
        finite ? fmt::format("a scan of {:.6g} s", (last - first) * usual.s)
               : std::string("a time that is not finite"),
        usual.name);
  }
  PointTimes times;
  const double middle = first + (last - first) / 2.0;
  times.middle_s = middle * unit->s;
  times.duration_s = (last - first) * unit->s;
  times.absolute = field.is_of_clock || std::abs(times.middle_s) > kSmallestClock_s;
  times.offset_s.reserve(field.values.size());
  for (const double t : field.values) {
    const bool wild = t < first || t > last;
    times.offset_s.push_back(wild ? NAN : static_cast<float>((t - middle) * unit->s));
  }
  return times;
}

std::optional<PointTimes> usable_times(const PointTimeField& field, double scan_period_s) {
  try {
    return point_times(field, scan_period_s, "");
  } catch (const Error&) {
    return std::nullopt;
  }
}

bool times_rise(const std::vector<PointTimeField>& fields, double scan_period_s) {
  std::optional<double> before_s;
  int rises = 0;
  for (const PointTimeField& field : fields) {
    const auto times = usable_times(field, scan_period_s);
    if (!times) continue;
    if (before_s && times->middle_s - *before_s < 0.5 * scan_period_s) return false;
    if (before_s) ++rises;
    before_s = times->middle_s;
  }
  return rises > 0;
}

std::vector<std::uint16_t> rows_from_rings(const std::vector<double>& ring, const Scan& scan,
                                           const SensorModel& sensor, const std::string& source,
                                           const std::string& field) {
  const double last_ring = sensor.rows() - 1;
  for (const double r : ring) {
    if (!(r >= 0.0 && r <= last_ring) || r != std::floor(r)) {
      throw Error(
          "{}: field '{}': expected 0 to {} for sensor '{}', found {}; name the sensor that "
          "recorded the scan",
          source, field, last_ring, sensor.name, r);
    }
  }
  const double correlation = correlation_with_elevation(ring, scan.points_m);
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
