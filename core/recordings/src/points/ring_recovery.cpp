#include "points/ring_recovery.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hqslam/core/error.h"
#include "hqslam/core/median.h"
#include "points/ring_segments.h"

// Rings of a scan whose points are stored ring after ring, top ring first.
//
// In:  points in the order of the file (sensor frame, metres), the sensor's beam table.
// Out: a row per point.
//
// Wraps of the azimuth alone do not separate the rings: one may be missing (a ring ends early and
// the next one begins late) or spurious (a stray point), and a ring may be empty. So each segment s
// of the scan (ring_segments.h), of n_s of all n points, is given a row r_s, never falling, such
// that the sum of three costs is least; e is the beam table, d the beam spacing:
//
//   heights     min(n_s, n_s-1) rows / n  min(2, |(h_s - h_s-1) - (e[r_s] - e[r_s-1])| / d[r_s])
//   elevations  n_s / n                   min(20, |median elevation_s - e[r_s]| / d[r_s])
//   order       after a wrap: 0 to the next row, kSpuriousWrap to the same row, and kSeenTwice for
//               all of its directions, as a ring goes around once;
//               after a gap: 0 to the same row, kMissedWrap to the next row;
//               kSkippedRow for each row that stays empty in between and before the first
//
// by dynamic programming over segments and rows, which is exact. A cost of 1 is one whole ring that
// is one beam spacing off. The elevations weigh so little that they decide only what the heights
// leave open: with which row the scan begins.

namespace hqslam::recordings {

namespace {

constexpr double kMaxFall = 2.0;
constexpr double kMaxElevation = 20.0;
constexpr double kSpuriousWrap = 0.6;
constexpr double kSeenTwice = 10.0;
constexpr double kMissedWrap = 0.2;
constexpr double kSkippedRow = 0.15;
/// Beyond these deviations, in beam spacings, a ring does not belong to the sensor.
constexpr double kMaxFallDeviation = 0.5;
constexpr double kMaxElevationDeviation = 3.0;
/// Far more than in any scan that is stored ring after ring; bounds time and memory.
constexpr std::size_t kMaxSegmentsPerRow = 16;

/// The dynamic programme described above.
class RowAssignment {
 public:
  RowAssignment(const SensorModel& sensor, const std::vector<RingSegment>& segments)
      : segments_(segments),
        rows_(sensor.rows()),
        points_per_row_(static_cast<double>(segments.back().end) / rows_),
        elevation_rad_(sensor.beam_elevation_rad),
        spacing_rad_(beam_spacing_rad(sensor)) {}

  std::vector<int> solve() const {
    std::vector<double> cost(rows_);
    std::vector<std::uint16_t> from_row(segments_.size() * rows_);
    for (int row = 0; row < rows_; ++row) cost[row] = kSkippedRow * row + elevation_cost(0, row);
    for (std::size_t s = 1; s < segments_.size(); ++s) {
      cost = advanced(s, cost, from_row.data() + s * rows_);
    }
    std::vector<int> row_of(segments_.size());
    row_of.back() = static_cast<int>(std::ranges::min_element(cost) - cost.begin());
    for (std::size_t s = segments_.size() - 1; s > 0; --s) {
      row_of[s - 1] = from_row[s * rows_ + row_of[s]];
    }
    return row_of;
  }

  /// In beam spacings.
  double elevation_deviation(std::size_t s, int row) const {
    return std::abs(segments_[s].elevation_rad - elevation_rad_[row]) / spacing_rad_[row];
  }
  /// elevation_deviation beyond what the parallax of lasers above the origin explains.
  double deviation_beyond_parallax(std::size_t s, int row) const {
    return std::max(0.0,
                    elevation_deviation(s, row) - segments_[s].parallax_rad / spacing_rad_[row]);
  }
  /// Deviation of the fall from an earlier segment, in row `from`, in beam spacings.
  double fall_deviation(std::size_t earlier, std::size_t s, int from, int row) const {
    const double fall_rad = segments_[s].height_rad - segments_[earlier].height_rad;
    return std::abs(fall_rad - (elevation_rad_[row] - elevation_rad_[from])) / spacing_rad_[row];
  }

 private:
  double rings_in(std::size_t s) const {
    return static_cast<double>(segments_[s].end - segments_[s].first) / points_per_row_;
  }

  /// The share of the directions of the smaller of this segment and the one before that both see.
  double seen_twice(std::size_t s) const {
    const auto& before = segments_[s - 1].looks_to;
    const auto& now = segments_[s].looks_to;
    const std::size_t fewer = std::min(before.count(), now.count());
    return fewer == 0 ? 0.0
                      : static_cast<double>((before & now).count()) / static_cast<double>(fewer);
  }

  double elevation_cost(std::size_t s, int row) const {
    return rings_in(s) / rows_ * std::min(elevation_deviation(s, row), kMaxElevation);
  }

  double step_cost(std::size_t s, int from, int row) const {
    const bool wrap = segments_[s].begins_with_wrap;
    double cost = std::min(rings_in(s - 1), rings_in(s)) *
                  std::min(fall_deviation(s - 1, s, from, row), kMaxFall);
    if (row == from) return cost + (wrap ? kSpuriousWrap + kSeenTwice * seen_twice(s) : 0.0);
    cost += kSkippedRow * (row - from - 1);
    return cost + (wrap ? 0.0 : kMissedWrap);
  }

  std::vector<double> advanced(std::size_t s, const std::vector<double>& cost,
                               std::uint16_t* from_row) const {
    std::vector<double> next(rows_, std::numeric_limits<double>::infinity());
    for (int row = 0; row < rows_; ++row) {
      for (int from = 0; from <= row; ++from) {
        const double candidate = cost[from] + step_cost(s, from, row);
        if (candidate >= next[row]) continue;
        next[row] = candidate;
        from_row[row] = static_cast<std::uint16_t>(from);
      }
      next[row] += elevation_cost(s, row);
    }
    return next;
  }

  const std::vector<RingSegment>& segments_;
  int rows_;
  double points_per_row_;
  const std::vector<double>& elevation_rad_;
  std::vector<double> spacing_rad_;
};

RingRecovery recovery_from(const std::vector<RingSegment>& segments, const std::vector<int>& row_of,
                           const RowAssignment& assignment, int rows) {
  RingRecovery recovery;
  std::vector<bool> used(rows, false);
  std::size_t off_table = 0;
  std::size_t last_sure = 0;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const RingSegment& segment = segments[s];
    recovery.row.resize(segment.end, static_cast<std::uint16_t>(row_of[s]));
    used[row_of[s]] = true;
    bool off = assignment.deviation_beyond_parallax(s, row_of[s]) > kMaxElevationDeviation;
    if (s > 0) {
      const bool new_row = row_of[s] != row_of[s - 1];
      recovery.spurious_wraps += static_cast<int>(segment.begins_with_wrap && !new_row);
      recovery.missed_wraps += static_cast<int>(!segment.begins_with_wrap && new_row);
      // The height of a ring seen in few directions does not predict that of a whole one, and that
      // of a ring seen in new directions is a guess.
      const RingSegment& before = segments[last_sure];
      const bool comparable =
          segment.is_sure && segment.end - segment.first < 2 * (before.end - before.first);
      off = off || (comparable && assignment.fall_deviation(last_sure, s, row_of[last_sure],
                                                            row_of[s]) > kMaxFallDeviation);
    }
    if (segment.is_sure) last_sure = s;
    if (off) off_table += segment.end - segment.first;
  }
  recovery.empty_rings = static_cast<int>(std::ranges::count(used, false));
  recovery.off_table_share =
      static_cast<double>(off_table) / static_cast<double>(recovery.row.size());
  return recovery;
}

}  // namespace

bool stored_ring_after_ring(const Scan& scan, const SensorModel& sensor) {
  if (scan.points_m.size() < 2) return true;
  const std::vector<float> tangent = elevation_tangents(scan);
  std::vector<float> steps;
  steps.reserve(tangent.size());
  for (std::size_t i = 1; i < tangent.size(); ++i) {
    steps.push_back(std::abs(tangent[i] - tangent[i - 1]));
  }
  return median(steps) < 0.5 * median_beam_spacing_rad(sensor);
}

RingRecovery recover_rings(const Scan& scan, const SensorModel& sensor) {
  if (scan.points_m.empty()) {
    RingRecovery recovery;
    recovery.empty_rings = sensor.rows();
    return recovery;
  }
  const std::vector<RingSegment> segments = ring_segments(scan, sensor);
  if (segments.size() > kMaxSegmentsPerRow * static_cast<std::size_t>(sensor.rows())) {
    throw Error(
        "expected points stored ring after ring, each once around in azimuth, found {} jumps of "
        "the azimuth in {} points; give scans as the sensor wrote them",
        segments.size() - 1, scan.points_m.size());
  }
  const RowAssignment assignment(sensor, segments);
  return recovery_from(segments, assignment.solve(), assignment, sensor.rows());
}

}  // namespace hqslam::recordings
