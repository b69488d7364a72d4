#include "points/beams_in_points.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "hqslam/core/angles.h"
#include "hqslam/core/median.h"
#include "points/ring_numbers.h"
#include "points/ring_segments.h"

// Points are assigned to beams by their rings, else by their order where each scan holds beam after
// beam (KITTI), else by the elevation: beams are the peaks of its histogram over all
// scans, parted where it falls below kValley of both peaks, but for peaks that were seen in
// different directions: those are parts of one beam.
//
// The laser of a beam may sit above or below the sensor's origin, as an HDL-64E's do by 0.1 to
// 0.2 m, or beside the axis, as an Ouster's: it then sees a point at the horizontal distance r
// under a slope tan e = s + h / r. Both are fitted by least squares, what is off by more than
// kOutlier times the median deviation left out. The beam's elevation is e where it meets flat
// ground, as far below the sensor as the lowest quarter of the beams measure, but no farther away
// than kFarthest_m: so it does not depend on what stands around the sensor, and comes near the
// medians of many scans.

namespace hqslam::recordings {

namespace {

/// Beams with a smaller share of the points of other beams are strays.
constexpr double kFewestShare = 0.01;
/// Nearer points are the vehicle's, or seen too obliquely.
constexpr double kNearest_m = 1.0;
constexpr double kFarthest_m = 26.0;
/// Lasers sit no farther from the origin.
constexpr double kLaserHeight_m = 0.3;
constexpr double kOutlier = 5.0;
constexpr double kBin_rad = 0.01 * kDegree_rad;
constexpr int kBins = 18000;
constexpr int kSmoothed = 3;  ///< bins to either side
constexpr double kValley = 0.3;
/// Where nothing else parts the beams they must be clearly apart.
constexpr double kNearestByElevation = 0.3;
constexpr double kWay_rad = 5.0 * kDegree_rad;

Sight sight_of(const Eigen::Vector3f& point_m, std::size_t scan) {
  const Eigen::Vector3d p = point_m.cast<double>();
  const double level_m = std::max(p.head<2>().norm(), 1e-6);
  return {scan, std::atan2(p.y(), p.x()), p.z() / level_m, 1.0 / level_m};
}

bool is_far(const Eigen::Vector3f& point_m) { return point_m.cast<double>().norm() > kNearest_m; }

/// Least squares over the sights that are off by less than `most_rad`.
void fit_line(Beam& beam, double most_rad) {
  double n = 0.0, sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_xy = 0.0;
  for (const Sight& sight : beam.sights) {
    if (std::abs(beam.off_rad(sight)) > most_rad) continue;
    n += 1.0;
    sum_x += sight.nearness_per_m;
    sum_y += sight.slope;
    sum_xx += sight.nearness_per_m * sight.nearness_per_m;
    sum_xy += sight.nearness_per_m * sight.slope;
  }
  const double spread = sum_xx - sum_x * sum_x / n;
  const double slope = spread > 1e-9 * n ? (sum_xy - sum_x * sum_y / n) / spread : 0.0;
  beam.height_m = std::clamp(slope, -kLaserHeight_m, kLaserHeight_m);
  beam.far_slope = (sum_y - beam.height_m * sum_x) / n;
}

Beam beam_of(Sights sights) {
  Beam beam;
  beam.sights = std::move(sights);
  std::vector<double> values;
  for (const Sight& sight : beam.sights) values.push_back(sight.slope);
  beam.far_slope = median(values);
  for (int pass = 0; pass < 3; ++pass) {
    values.clear();
    for (const Sight& sight : beam.sights) values.push_back(std::abs(beam.off_rad(sight)));
    fit_line(beam, kOutlier * median(values) + 1e-9);
  }
  beam.elevation_rad = beam.elevation_at_rad(kFarthest_m);
  return beam;
}

/// The sensor's height over the ground, from the lowest quarter of its beams.
double height_over_ground_m(const std::vector<Beam>& beams) {
  std::vector<double> heights_m;
  for (std::size_t i = beams.size() - (beams.size() + 3) / 4; i < beams.size(); ++i) {
    for (const Sight& sight : beams[i].sights) {
      heights_m.push_back(-sight.slope / sight.nearness_per_m);
    }
  }
  return median(heights_m);
}

void look_at_ground(Beam& beam, double height_over_ground_m) {
  constexpr int kPasses = 10;
  for (int pass = 0; pass < kPasses; ++pass) {
    const double fall_m = -kFarthest_m * std::tan(beam.elevation_rad);
    const double share = fall_m > height_over_ground_m ? height_over_ground_m / fall_m : 1.0;
    beam.elevation_rad = beam.elevation_at_rad(share * kFarthest_m);
  }
}

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

/// Directions of scans.
using Ways = std::set<std::pair<std::size_t, long>>;

Ways ways_of(const Sights& sights) {
  Ways ways;
  for (const Sight& sight : sights) {
    ways.emplace(sight.scan, std::lround(sight.azimuth_rad / kWay_rad));
  }
  return ways;
}

/// As of two beams; what one beam sees nearer in some directions, or moved on, it sees only there.
bool mostly_common(const Ways& a, const Ways& b) {
  const auto common = std::ranges::count_if(a, [&](const auto& way) { return b.contains(way); });
  return 2 * common >= std::ssize(a.size() < b.size() ? a : b);
}

}  // namespace

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
  std::vector<int> numbers;
  for (const auto& [ring, sights] : groups) numbers.push_back(ring);
  Beams result = beams_of(groups);
  if (numbers.empty()) return result;
  const auto [first, step] = RingNumbers::of(numbers);
  // Rings from 2 on are those of a sensor that has others, of which nothing came back.
  result.rings = (numbers.back() - (step == 1 && first > 1 ? 0 : first)) / step + 1;
  return result;
}

Beams beams_by_order(const std::vector<RawPoints>& scans) {
  std::vector<std::vector<std::size_t>> begins;
  std::map<std::size_t, std::size_t> scans_of_count;
  for (const RawPoints& raw : scans) {
    begins.push_back(ring_begins(raw.scan));
    ++scans_of_count[begins.back().size()];
  }
  const auto most =
      std::ranges::max_element(scans_of_count, {}, [](const auto& of) { return of.second; });
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

Beams beams_by_elevation(const std::vector<RawPoints>& scans) {
  Sights sights;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    for (const Eigen::Vector3f& point_m : scans[s].scan.points_m) {
      if (is_far(point_m)) sights.push_back(sight_of(point_m, s));
    }
  }
  const auto bin_of = [](const Sight& sight) {
    return std::clamp(static_cast<int>(std::atan(sight.slope) / kBin_rad + kBins / 2.0), 0,
                      kBins - 1);
  };
  std::vector<double> counts(kBins);
  for (const Sight& sight : sights) {
    const int bin = bin_of(sight);
    const int last = std::min(bin + kSmoothed, kBins - 1);
    for (int b = std::max(bin - kSmoothed, 0); b <= last; ++b) counts[b] += 1.0;
  }
  const std::vector<int> peak_of_bin = peaks_of(counts);
  std::map<int, Sights> peaks;
  for (const Sight& sight : sights) peaks[peak_of_bin[bin_of(sight)]].push_back(sight);
  std::map<int, Sights> groups;
  Ways of_last;
  for (auto& [peak, its] : peaks) {
    Ways ways = ways_of(its);
    const bool is_part = !groups.empty() && !mostly_common(of_last, ways);
    if (!is_part) of_last.clear();
    of_last.merge(ways);
    Sights& group = is_part ? groups.rbegin()->second : groups[peak];
    group.insert(group.end(), its.begin(), its.end());
  }
  Beams result = beams_of(groups);
  result.nearest = kNearestByElevation;
  return result;
}

}  // namespace hqslam::recordings
