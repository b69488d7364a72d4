#include "hqslam/core/sensor_finder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "hqslam/core/error.h"
#include "ring_segments.h"

// The beams of a sensor, found in the points of some of its scans.
//
// In:  points in the sensor frame, metres, with the numbers of their rings where the file has them.
// Out: the elevation of each beam, highest first; columns.
//
// Which points are of one beam is told by their rings, else by their order where each scan holds
// beam after beam (KITTI), else by the elevation: beams are the peaks of its histogram over all
// scans, parted where it falls below kValley of both peaks.
//
// The laser of a beam may sit h above or below the sensor's origin, as an HDL-64E's do by 0.1 to
// 0.2 m: it then sees a point at the horizontal distance r under e = e_0 + h / r. Both are fitted
// by least squares, what is off by more than kOutlier times the median deviation left out. The
// beam's elevation is e where it meets flat ground, as high below the sensor as the lowest quarter
// of the beams say, but no farther away than kFarthest_m: so it does not depend on what stands
// around the sensor, and comes near the medians of many scans.
//
// A sensor is believed if hardly any point lies nearer to another beam than to its own, and if each
// scan alone says the same.

namespace hqslam {

namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;

constexpr int kFewestBeams = 4;
constexpr int kMostBeams = 256;
constexpr std::size_t kFewestPoints = 30;
/// Of what other beams have: fewer are strays.
constexpr double kFewestShare = 0.01;
/// What is nearer is the vehicle, or seen too askew to say anything.
constexpr double kNearest_m = 1.0;
constexpr double kFarthest_m = 26.0;
/// Lasers sit no farther from the origin.
constexpr double kLaserHeight_m = 0.3;
constexpr double kOutlier = 5.0;
constexpr double kMostBetweenBeams = 0.05;
constexpr double kMostContradicting = 0.1;
/// Of the beams in single scans.
constexpr double kLeastSeen = 0.7;
/// A beam is a preset's, or that of another scan, within this.
constexpr double kSameBeam_rad = 0.15 * kDegree_rad;

constexpr double kBin_rad = 0.01 * kDegree_rad;
constexpr int kBins = 18000;
constexpr int kSmoothed = 3;  ///< bins to either side
constexpr double kValley = 0.3;

constexpr double kDefaultPeriod_s = 0.1;
constexpr int kDefaultColumns = 1024;

struct Sight {
  std::size_t scan = 0;
  double azimuth_rad = 0.0;
  double elevation_rad = 0.0;
  double nearness_per_m = 0.0;  ///< one by the horizontal distance
};
using Sights = std::vector<Sight>;

struct Beam {
  double elevation_rad = 0.0;  ///< on flat ground
  double straight_rad = 0.0;   ///< e_0
  double height_m = 0.0;       ///< h
  Sights sights;

  double off_rad(const Sight& sight) const {
    return sight.elevation_rad - straight_rad - height_m * sight.nearness_per_m;
  }
};

Sight sight_of(const Eigen::Vector3f& point_m, std::size_t scan) {
  const Eigen::Vector3d p = point_m.cast<double>();
  const double level_m = std::max(p.head<2>().norm(), 1e-6);
  return {scan, std::atan2(p.y(), p.x()), std::atan2(p.z(), level_m), 1.0 / level_m};
}

bool is_far(const Eigen::Vector3f& point_m) { return point_m.cast<double>().norm() > kNearest_m; }

double quantile(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Least squares over the sights that are off by less than `most_rad`.
void fit_line(Beam& beam, double most_rad) {
  double n = 0.0, sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_xy = 0.0;
  for (const Sight& sight : beam.sights) {
    if (std::abs(beam.off_rad(sight)) > most_rad) continue;
    n += 1.0;
    sum_x += sight.nearness_per_m;
    sum_y += sight.elevation_rad;
    sum_xx += sight.nearness_per_m * sight.nearness_per_m;
    sum_xy += sight.nearness_per_m * sight.elevation_rad;
  }
  const double spread = sum_xx - sum_x * sum_x / n;
  const double slope = spread > 1e-9 * n ? (sum_xy - sum_x * sum_y / n) / spread : 0.0;
  beam.height_m = std::clamp(slope, -kLaserHeight_m, kLaserHeight_m);
  beam.straight_rad = (sum_y - beam.height_m * sum_x) / n;
}

Beam beam_of(Sights sights) {
  Beam beam;
  beam.sights = std::move(sights);
  std::vector<double> values;
  for (const Sight& sight : beam.sights) values.push_back(sight.elevation_rad);
  beam.straight_rad = median(values);
  for (int pass = 0; pass < 3; ++pass) {
    values.clear();
    for (const Sight& sight : beam.sights) values.push_back(std::abs(beam.off_rad(sight)));
    fit_line(beam, kOutlier * median(values) + 1e-9);
  }
  beam.elevation_rad = beam.straight_rad + beam.height_m / kFarthest_m;
  return beam;
}

/// Of the sensor over the ground, by the lowest quarter of its beams.
double height_over_ground_m(const std::vector<Beam>& beams) {
  std::vector<double> heights_m;
  for (std::size_t i = beams.size() - (beams.size() + 3) / 4; i < beams.size(); ++i) {
    for (const Sight& sight : beams[i].sights) {
      heights_m.push_back(-std::tan(sight.elevation_rad) / sight.nearness_per_m);
    }
  }
  return median(heights_m);
}

void look_at_ground(Beam& beam, double height_over_ground_m) {
  constexpr int kPasses = 10;
  for (int pass = 0; pass < kPasses; ++pass) {
    const double fall_m = -kFarthest_m * std::tan(beam.elevation_rad);
    const double share = fall_m > height_over_ground_m ? height_over_ground_m / fall_m : 1.0;
    beam.elevation_rad = beam.straight_rad + beam.height_m / (share * kFarthest_m);
  }
}

/// Highest first.
struct Beams {
  std::vector<Beam> beams;
  double strays = 0.0;  ///< points of none
  int rings = 0;        ///< that there must be by their numbers, seen or not; 0: unknown
};

template <typename Groups>
Beams beams_of(Groups& groups) {
  std::vector<std::size_t> sizes;
  for (const auto& [label, sights] : groups) sizes.push_back(sights.size());
  if (sizes.empty()) return {};
  const auto usual = static_cast<double>(median(sizes));
  Beams result;
  for (auto& [label, sights] : groups) {
    const auto points = static_cast<double>(sights.size());
    if (sights.size() < kFewestPoints || points < kFewestShare * usual) {
      result.strays += points;
    } else {
      result.beams.push_back(beam_of(std::move(sights)));
    }
  }
  std::ranges::sort(result.beams, std::greater<>(), &Beam::elevation_rad);
  if (result.beams.empty()) return result;
  const double height_m = height_over_ground_m(result.beams);
  if (!(height_m > kNearest_m / 10.0)) return result;  // over water, or on its head
  for (Beam& beam : result.beams) look_at_ground(beam, height_m);
  std::ranges::sort(result.beams, std::greater<>(), &Beam::elevation_rad);
  return result;
}

Beams beams_by_rings(const std::vector<RawPoints>& scans) {
  std::map<int, Sights> groups;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const auto& points_m = scans[s].scan.points_m;
    if (scans[s].ring.size() != points_m.size()) return {};
    for (std::size_t i = 0; i < points_m.size(); ++i) {
      const double ring = scans[s].ring[i];
      if (!(ring >= 0.0 && ring < kMostBeams) || ring != std::floor(ring)) return {};
      if (is_far(points_m[i])) groups[static_cast<int>(ring)].push_back(sight_of(points_m[i], s));
    }
  }
  Beams result = beams_of(groups);
  if (!groups.empty()) result.rings = groups.rbegin()->first + 1;
  return result;
}

/// Of scans that hold beam after beam: those that most of them have, in the order of the points.
Beams beams_by_order(const std::vector<RawPoints>& scans) {
  std::vector<std::vector<std::size_t>> begins;
  std::map<std::size_t, std::size_t> scans_of_count;
  for (const RawPoints& raw : scans) {
    begins.push_back(ring_begins(raw.scan));
    ++scans_of_count[begins.back().size()];
  }
  const auto most = std::ranges::max_element(
      scans_of_count, [](const auto& a, const auto& b) { return a.second < b.second; });
  if (2 * most->second <= scans.size() || most->first > kMostBeams) return {};
  std::map<std::size_t, Sights> groups;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    if (begins[s].size() != most->first) continue;
    const auto& points_m = scans[s].scan.points_m;
    for (std::size_t i = 0, ring = 0; i < points_m.size(); ++i) {
      while (ring + 1 < begins[s].size() && begins[s][ring + 1] <= i) ++ring;
      if (is_far(points_m[i])) groups[ring].push_back(sight_of(points_m[i], s));
    }
  }
  return beams_of(groups);
}

/// For each bin the first one of its peak.
std::vector<int> peaks_of(const std::vector<double>& counts) {
  std::vector<int> peak_of_bin(counts.size());
  int begin = 0, lowest = 0;
  double peak = 0.0;
  for (int bin = 0; bin < std::ssize(counts); ++bin) {
    if (counts[bin] < counts[lowest]) lowest = bin;
    if (counts[lowest] <= kValley * std::min(peak, counts[bin]) && counts[bin] > 0.0) {
      std::fill(peak_of_bin.begin() + begin, peak_of_bin.begin() + lowest, begin);
      begin = lowest;
      peak = 0.0;
    }
    if (counts[bin] > peak) {
      peak = counts[bin];
      lowest = bin;
    }
  }
  std::fill(peak_of_bin.begin() + begin, peak_of_bin.end(), begin);
  return peak_of_bin;
}

Beams beams_by_elevation(const std::vector<RawPoints>& scans) {
  Sights sights;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    for (const Eigen::Vector3f& point_m : scans[s].scan.points_m) {
      if (is_far(point_m)) sights.push_back(sight_of(point_m, s));
    }
  }
  const auto bin_of = [](const Sight& sight) {
    return std::clamp(static_cast<int>(sight.elevation_rad / kBin_rad + kBins / 2.0), 0, kBins - 1);
  };
  std::vector<double> counts(kBins);
  for (const Sight& sight : sights) {
    const int bin = bin_of(sight);
    const int last = std::min(bin + kSmoothed, kBins - 1);
    for (int b = std::max(bin - kSmoothed, 0); b <= last; ++b) counts[b] += 1.0;
  }
  const std::vector<int> peak_of_bin = peaks_of(counts);
  std::map<int, Sights> groups;
  for (const Sight& sight : sights) groups[peak_of_bin[bin_of(sight)]].push_back(sight);
  return beams_of(groups);
}

/// Half the way to the nearer neighbour.
double half_spacing_rad(const std::vector<Beam>& beams, std::size_t i) {
  double spacing_rad = 2.0 * std::numbers::pi;
  for (const std::size_t j : {i - 1, i + 1}) {  // before the first: beyond the last
    if (j >= beams.size()) continue;
    spacing_rad = std::min(spacing_rad, std::abs(beams[i].elevation_rad - beams[j].elevation_rad));
  }
  return spacing_rad / 2.0;
}

/// What speaks against these beams; "" if nothing does.
std::string complaint(const Beams& found, std::size_t scans) {
  const std::vector<Beam>& beams = found.beams;
  if (beams.size() < kFewestBeams || beams.size() > kMostBeams) {
    return fmt::format("found {} beams that are clearly apart", beams.size());
  }
  double points = found.strays, between = found.strays, seen = 0.0, contradicting = 0.0;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const double half_rad = half_spacing_rad(beams, i);
    std::vector<std::vector<double>> off_rad(scans);
    for (const Sight& sight : beams[i].sights) {
      off_rad[sight.scan].push_back(beams[i].off_rad(sight));
      points += 1.0;
      between += std::abs(off_rad[sight.scan].back()) > half_rad ? 1.0 : 0.0;
    }
    for (std::vector<double>& off : off_rad) {
      if (off.size() < kFewestPoints) continue;
      seen += 1.0;
      contradicting += std::abs(median(off)) > std::min(half_rad / 2.0, kSameBeam_rad) ? 1.0 : 0.0;
    }
  }
  if (between > kMostBetweenBeams * points) {
    return fmt::format("found {} beams, but {:.0f} % of the points between them", beams.size(),
                       100.0 * between / points);
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
    // A sensor that turns faster than usual; finer images than a preset's are none that it lacks.
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

}  // namespace

FoundSensor find_sensor(const std::vector<RawPoints>& scans, std::optional<double> scan_period_s,
                        const std::string& source) {
  std::string wrong = "found no points";
  for (const Way& way : kWays) {
    if (scans.empty()) break;
    const Beams told = way.find(scans);
    wrong = complaint(told, scans.size());
    const bool has_rings = told.rings >= kFewestBeams;
    if (!wrong.empty() && has_rings) break;
    if (!wrong.empty()) continue;
    const std::vector<Beam>& beams = told.beams;
    FoundSensor found = sensor_with(beams);
    if (found.sensor.rows() < told.rings) {
      wrong = fmt::format("found points of {} of {} rings", beams.size(), told.rings);
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
  throw Error(
      "{}: does not say which sensor it was recorded with, and its points do not either: {}; give "
      "--sensor NAME or --sensor FILE.json",
      source, wrong);
}

}  // namespace hqslam
