#include "hqslam/core/ring_recovery.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "hqslam/core/error.h"

// Rings of a scan whose points are stored ring after ring, top ring first.
//
// In:  points in the order of the file (sensor frame, metres), the sensor's beam table.
// Out: a row per point.
//
// The azimuth of the points, counted in the direction of rotation from the seam where rings begin,
// rises within a ring and falls back where the next one begins: a wrap. Wraps alone fail when one
// is missing (a ring ends early and the next one begins late) or spurious (a stray point), or when
// a ring is empty. What helps is the elevation, but not its absolute value: the lasers of an
// HDL-64E do not meet in one point, so what is near is seen up to two beam spacings off. Two rings
// are off by the same amount where they look the same way, though: the fall of the elevation from
// ring to ring at one azimuth follows the beam table to a tenth of a spacing.
//
// So the height h of each ring is followed through the scan: at each azimuth the height of the ring
// last seen there less the fall since then, and of these the median. The scan is cut into segments
// at each wrap, and at a large gap of the azimuth (the only place where a wrap can hide) if all
// that follows up to the next wrap lies lower. Each segment s, of n_s points, is given a row r_s,
// never falling, such that the sum of
//   heights     min(n_s, n_s-1) / (n / rows) * min(|(h_s - h_s-1) - (e[r_s] - e[r_s-1])| /
//   spacing[r_s], 2) elevations  n_s / (n / rows) * min(|median elevation_s - e[r_s]| /
//   spacing[r_s], 2) / 10 order       after a wrap: 0 to the next row, kSpuriousWrap to the same
//   row
//               after a gap:  0 to the same row, kMissedWrap to the next row
//               kSkippedRow for each row in between that stays empty, and before the first
// is least, where e is the beam table: dynamic programming over segments and rows, exact.
// A cost of 1 is thus one whole ring that is one beam spacing off. The elevations weigh so little
// that they decide only what the heights leave open: with which row the scan begins.

namespace hqslam {

namespace {

constexpr float kTwoPi = 2.0F * std::numbers::pi_v<float>;
/// Azimuth falls back by more than this only where a ring begins; jitter is a hundred times less.
constexpr float kWrap_rad = 0.05F;
/// Ten times the azimuth step of a slow sensor.
constexpr float kGap_rad = 0.035F;
constexpr double kMaxFall = 2.0;
constexpr double kMaxElevation = 20.0;
constexpr double kSpuriousWrap = 0.6;
constexpr double kMissedWrap = 0.2;
constexpr double kSkippedRow = 0.15;
/// How far the height must fall across a gap, in beam spacings, to count as a possible wrap.
constexpr double kFallAcrossGap = 0.4;
/// Beyond these deviations, in beam spacings, a ring does not belong to the sensor.
constexpr double kMaxFallDeviation = 0.5;
constexpr double kMaxElevationDeviation = 3.0;
constexpr int kAzimuthBins = 72;
constexpr int kMinPointsPerBin = 3;
/// A part of a ring smaller than this is no evidence of a ring of its own.
constexpr double kMinRingShareAfterGap = 0.03;
/// Far more than in any scan that is stored ring after ring; bounds time and memory.
constexpr std::size_t kMaxSegmentsPerRow = 16;

/// A run of points without a wrap or a gap inside.
struct Piece {
  std::size_t first = 0;
  std::size_t end = 0;
  bool begins_with_wrap = false;
};

/// Pieces that belong to one ring.
struct Segment {
  std::size_t first = 0;
  std::size_t end = 0;
  bool begins_with_wrap = false;
  double height_rad = 0.0;
  double elevation_rad = 0.0;  ///< median of its points
};

/// Mean elevation of some points of one ring within one bin of azimuth.
struct BinElevation {
  int bin = 0;
  double elevation_rad = 0.0;
};

std::vector<float> azimuths_rad(const Scan& scan) {
  std::vector<float> azimuth_rad;
  azimuth_rad.reserve(scan.points_m.size());
  for (const Eigen::Vector3f& p : scan.points_m) azimuth_rad.push_back(std::atan2(p.y(), p.x()));
  return azimuth_rad;
}

/// Tangent of the elevation: rises with it, at a fraction of the cost.
std::vector<float> elevation_tangents(const Scan& scan) {
  std::vector<float> tangent;
  tangent.reserve(scan.points_m.size());
  for (const Eigen::Vector3f& p : scan.points_m) {
    const float horizontal_m = std::sqrt(p.x() * p.x() + p.y() * p.y());
    tangent.push_back(p.z() / std::max(horizontal_m, 1e-6F));
  }
  return tangent;
}

template <typename T>
T median(std::vector<T>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Distance of each beam to its neighbours.
std::vector<double> beam_spacing_rad(const SensorModel& sensor) {
  const auto& elevation_rad = sensor.beam_elevation_rad;
  const int rows = sensor.rows();
  if (rows == 1) return {kTwoPi / 360.0};
  std::vector<double> spacing_rad;
  for (int row = 0; row < rows; ++row) {
    const int above = std::max(row - 1, 0);
    const int below = std::min(row + 1, rows - 1);
    spacing_rad.push_back((elevation_rad[above] - elevation_rad[below]) / (below - above));
  }
  return spacing_rad;
}

double median_beam_spacing_rad(const SensorModel& sensor) {
  std::vector<double> spacing_rad = beam_spacing_rad(sensor);
  return median(spacing_rad);
}

/// +1 if the azimuth rises from point to point, -1 if it falls.
float direction_of_rotation(const std::vector<float>& azimuth_rad) {
  std::int64_t balance = 0;
  for (std::size_t i = 1; i < azimuth_rad.size(); ++i) {
    const float step_rad = azimuth_rad[i] - azimuth_rad[i - 1];
    if (std::abs(step_rad) < kGap_rad) balance += step_rad > 0.0F ? 1 : -1;
  }
  return balance >= 0 ? 1.0F : -1.0F;
}

/// Angle of each point from the seam on in the direction of rotation, 0..2 pi.
std::vector<float> angles_from_seam_rad(const std::vector<float>& azimuth_rad, float direction,
                                        float seam_rad) {
  std::vector<float> angle_rad;
  angle_rad.reserve(azimuth_rad.size());
  for (const float azimuth : azimuth_rad) {
    float angle = direction * (azimuth - seam_rad);
    if (angle < 0.0F) angle += kTwoPi;
    if (angle >= kTwoPi) angle -= kTwoPi;
    angle_rad.push_back(angle);
  }
  return angle_rad;
}

/// By how much the elevation typically falls across the seam: about one beam spacing where rings
/// begin, nothing elsewhere.
float fall_across_seam(const std::vector<float>& angle_rad, const std::vector<float>& tangent) {
  constexpr std::size_t kPoints = 8;
  std::vector<float> falls;
  for (std::size_t i = kPoints; i + kPoints <= angle_rad.size(); ++i) {
    if (angle_rad[i] >= angle_rad[i - 1] - kWrap_rad) continue;
    const auto at = tangent.begin() + static_cast<std::ptrdiff_t>(i);
    std::vector<float> before(at - kPoints, at);
    std::vector<float> after(at, at + kPoints);
    falls.push_back(median(before) - median(after));
  }
  return falls.empty() ? 0.0F : median(falls);
}

/// The angles from the front or from the back, wherever rings begin.
std::vector<float> angles_from_ring_begin_rad(const std::vector<float>& azimuth_rad,
                                              const std::vector<float>& tangent) {
  const float direction = direction_of_rotation(azimuth_rad);
  std::vector<float> from_front = angles_from_seam_rad(azimuth_rad, direction, 0.0F);
  std::vector<float> from_back =
      angles_from_seam_rad(azimuth_rad, direction, std::numbers::pi_v<float>);
  const bool back = fall_across_seam(from_back, tangent) > fall_across_seam(from_front, tangent);
  return back ? from_back : from_front;
}

std::vector<Piece> cut_into_pieces(const std::vector<float>& angle_rad) {
  std::vector<Piece> pieces(1);
  for (std::size_t i = 1; i < angle_rad.size(); ++i) {
    const float step_rad = angle_rad[i] - angle_rad[i - 1];
    const bool wrap = step_rad < -kWrap_rad;
    if (!wrap && step_rad < kGap_rad) continue;
    pieces.back().end = i;
    pieces.push_back({i, i, wrap});
  }
  pieces.back().end = angle_rad.size();
  return pieces;
}

/// Follows the height of the rings through the scan and cuts it into segments.
class HeightTracker {
 public:
  HeightTracker(const std::vector<float>& angle_rad, const std::vector<float>& tangent,
                double spacing_rad, double points_per_row)
      : angle_rad_(angle_rad),
        tangent_(tangent),
        spacing_rad_(spacing_rad),
        min_points_after_gap_(kMinRingShareAfterGap * points_per_row) {}

  std::vector<Segment> segments(const std::vector<Piece>& pieces) {
    for (std::size_t begin = 0; begin < pieces.size();) {
      std::size_t end = begin + 1;
      while (end < pieces.size() && !pieces[end].begins_with_wrap) ++end;
      add_turn({pieces.begin() + static_cast<std::ptrdiff_t>(begin),
                pieces.begin() + static_cast<std::ptrdiff_t>(end)});
      begin = end;
    }
    return std::move(segments_);
  }

 private:
  struct LastSeen {
    bool seen = false;
    double elevation_rad = 0.0;
    double height_rad = 0.0;
  };

  std::vector<BinElevation> bins_of(const Piece& piece) const {
    std::vector<BinElevation> bins;
    const auto bin_of = [&](std::size_t i) {
      return std::min(static_cast<int>(angle_rad_[i] / kTwoPi * kAzimuthBins), kAzimuthBins - 1);
    };
    for (std::size_t i = piece.first; i < piece.end;) {
      const int bin = bin_of(i);
      double sum = 0.0;
      int points = 0;
      for (; i < piece.end && bin_of(i) == bin; ++i, ++points) sum += tangent_[i];
      if (points >= kMinPointsPerBin) bins.push_back({bin, std::atan(sum / points)});
    }
    return bins;
  }

  /// Whether these bins look at directions that were seen before.
  bool has_height(const std::vector<BinElevation>& bins) const {
    return std::any_of(bins.begin(), bins.end(),
                       [&](const BinElevation& b) { return last_[b.bin].seen; });
  }

  /// Of the bins that look at directions seen before.
  std::vector<double> heights_rad(const std::vector<BinElevation>& bins) const {
    std::vector<double> result;
    for (const BinElevation& b : bins) {
      const LastSeen& last = last_[b.bin];
      if (last.seen) result.push_back(last.height_rad + b.elevation_rad - last.elevation_rad);
    }
    return result;
  }

  static std::vector<double> elevations_rad(const std::vector<BinElevation>& bins) {
    std::vector<double> result;
    for (const BinElevation& b : bins) result.push_back(b.elevation_rad);
    return result;
  }

  struct Fall {
    double fall_rad = 0.0;       ///< from the median of what comes before to that of what follows
    double deviation_rad = 0.0;  ///< mean absolute deviation from the two medians
  };

  Fall fall_between(const std::vector<BinElevation>& before,
                    const std::vector<BinElevation>& after) const {
    if (before.empty() || after.empty()) return {};
    // Where nothing was seen before, the fall of the elevation itself must do.
    const bool comparable = has_height(before) && has_height(after);
    Fall fall;
    double count = 0.0;
    for (const auto& [bins, sign] : {std::pair(&before, 1.0), std::pair(&after, -1.0)}) {
      std::vector<double> values = comparable ? heights_rad(*bins) : elevations_rad(*bins);
      const double middle = median(values);
      for (const double value : values) fall.deviation_rad += std::abs(value - middle);
      fall.fall_rad += sign * middle;
      count += static_cast<double>(values.size());
    }
    fall.deviation_rad /= count;
    return fall;
  }

  /// The points from one wrap to the next: one segment, or more where the height falls at a gap.
  void add_turn(const std::vector<Piece>& pieces) {
    std::vector<std::vector<BinElevation>> bins;
    for (const Piece& piece : pieces) bins.push_back(bins_of(piece));
    const auto joined = [&](std::size_t begin, std::size_t end) {
      std::vector<BinElevation> all;
      for (std::size_t i = begin; i < end; ++i)
        all.insert(all.end(), bins[i].begin(), bins[i].end());
      return all;
    };
    for (std::size_t begin = 0; begin < pieces.size();) {
      // Where the rest of the turn lies lower than what is before it and both are most even.
      std::size_t cut = pieces.size();
      double least_deviation_rad = std::numeric_limits<double>::infinity();
      for (std::size_t i = begin + 1; i < pieces.size(); ++i) {
        if (static_cast<double>(pieces.back().end - pieces[i].first) < min_points_after_gap_) break;
        const Fall fall = fall_between(joined(begin, i), joined(i, pieces.size()));
        if (fall.fall_rad < kFallAcrossGap * spacing_rad_) continue;
        if (fall.deviation_rad >= least_deviation_rad) continue;
        least_deviation_rad = fall.deviation_rad;
        cut = i;
      }
      add_segment(
          {pieces[begin].first, pieces[cut - 1].end, pieces[begin].begins_with_wrap, 0.0, 0.0},
          joined(begin, cut));
      begin = cut;
    }
  }

  void add_segment(Segment segment, const std::vector<BinElevation>& bins) {
    std::vector<float> values(tangent_.begin() + static_cast<std::ptrdiff_t>(segment.first),
                              tangent_.begin() + static_cast<std::ptrdiff_t>(segment.end));
    segment.elevation_rad = std::atan(median(values));
    if (has_height(bins)) {
      std::vector<double> heights = heights_rad(bins);
      segment.height_rad = median(heights);
    } else if (segments_.empty()) {
      segment.height_rad = segment.elevation_rad;
    } else {
      const Segment& last = segments_.back();
      segment.height_rad = last.height_rad + segment.elevation_rad - last.elevation_rad;
    }
    for (const BinElevation& b : bins) last_[b.bin] = {true, b.elevation_rad, segment.height_rad};
    segments_.push_back(segment);
  }

  const std::vector<float>& angle_rad_;
  const std::vector<float>& tangent_;
  double spacing_rad_;
  double min_points_after_gap_;
  std::array<LastSeen, kAzimuthBins> last_;
  std::vector<Segment> segments_;
};

/// The dynamic programme described above.
class RowAssignment {
 public:
  RowAssignment(const SensorModel& sensor, const std::vector<Segment>& segments)
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
    row_of.back() = static_cast<int>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    for (std::size_t s = segments_.size() - 1; s > 0; --s) {
      row_of[s - 1] = from_row[s * rows_ + row_of[s]];
    }
    return row_of;
  }

  /// In beam spacings.
  double elevation_deviation(std::size_t s, int row) const {
    return std::abs(segments_[s].elevation_rad - elevation_rad_[row]) / spacing_rad_[row];
  }
  double fall_deviation(std::size_t s, int from, int row) const {
    const double fall_rad = segments_[s].height_rad - segments_[s - 1].height_rad;
    return std::abs(fall_rad - (elevation_rad_[row] - elevation_rad_[from])) / spacing_rad_[row];
  }

 private:
  double rings_in(std::size_t s) const {
    return static_cast<double>(segments_[s].end - segments_[s].first) / points_per_row_;
  }

  double elevation_cost(std::size_t s, int row) const {
    return rings_in(s) / rows_ * std::min(elevation_deviation(s, row), kMaxElevation);
  }

  double step_cost(std::size_t s, int from, int row) const {
    const bool wrap = segments_[s].begins_with_wrap;
    double cost =
        std::min(rings_in(s - 1), rings_in(s)) * std::min(fall_deviation(s, from, row), kMaxFall);
    if (row == from) return cost + (wrap ? kSpuriousWrap : 0.0);
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

  const std::vector<Segment>& segments_;
  int rows_;
  double points_per_row_;
  const std::vector<double>& elevation_rad_;
  std::vector<double> spacing_rad_;
};

RingRecovery recovery_from(const std::vector<Segment>& segments, const std::vector<int>& row_of,
                           const RowAssignment& assignment, int rows) {
  RingRecovery recovery;
  std::vector<bool> used(rows, false);
  std::size_t off_table = 0;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    const Segment& segment = segments[s];
    recovery.row.resize(segment.end, static_cast<std::uint16_t>(row_of[s]));
    used[row_of[s]] = true;
    bool off = assignment.elevation_deviation(s, row_of[s]) > kMaxElevationDeviation;
    if (s > 0) {
      const bool new_row = row_of[s] != row_of[s - 1];
      recovery.spurious_wraps += static_cast<int>(segment.begins_with_wrap && !new_row);
      recovery.missed_wraps += static_cast<int>(!segment.begins_with_wrap && new_row);
      // The height of a ring seen in a few directions says nothing about a whole one.
      const bool comparable =
          segment.end - segment.first < 2 * (segments[s - 1].end - segments[s - 1].first);
      off = off || (comparable &&
                    assignment.fall_deviation(s, row_of[s - 1], row_of[s]) > kMaxFallDeviation);
    }
    if (off) off_table += segment.end - segment.first;
  }
  recovery.empty_rings = static_cast<int>(std::count(used.begin(), used.end(), false));
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
  const std::vector<float> tangent = elevation_tangents(scan);
  const std::vector<float> angle_rad = angles_from_ring_begin_rad(azimuths_rad(scan), tangent);
  const double points_per_row = static_cast<double>(scan.points_m.size()) / sensor.rows();
  HeightTracker tracker(angle_rad, tangent, median_beam_spacing_rad(sensor), points_per_row);
  const std::vector<Segment> segments = tracker.segments(cut_into_pieces(angle_rad));
  if (segments.size() > kMaxSegmentsPerRow * static_cast<std::size_t>(sensor.rows())) {
    throw Error(
        fmt::format("expected points stored ring after ring, each once around in azimuth, "
                    "found {} jumps of the azimuth in {} points; give scans as the sensor "
                    "wrote them",
                    segments.size() - 1, scan.points_m.size()));
  }
  const RowAssignment assignment(sensor, segments);
  return recovery_from(segments, assignment.solve(), assignment, sensor.rows());
}

}  // namespace hqslam
