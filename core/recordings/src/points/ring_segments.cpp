#include "points/ring_segments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "hqslam/core/median.h"

// The azimuth of the points, counted in the direction of rotation from the seam where rings begin,
// rises within a ring and falls back where the next one begins: a wrap.
//
// The height h of each ring is its elevation without the error of the absolute elevation: the
// lasers of an HDL-64E do not meet in one point, so near points appear up to two beam spacings off.
// Two rings are off by the same amount where they have the same azimuth, though. So, with
// e_s(a) the mean elevation of segment s at azimuth a (bins of 5 degrees) and l(a) the segment last
// seen there before,
//   h_s = median over a of  h_l(a) + e_s(a) - e_l(a)(a)
// and the fall of h from ring to ring follows the beam table to a tenth of a beam spacing. A
// segment at azimuths where no ring was seen before is compared with others by its elevation, which
// is uncertain by the parallax of lasers that far apart (kLaserApart_m / distance); heights of
// other rings at those azimuths take precedence over it.

namespace hqslam::recordings {

namespace {

constexpr float kCircle_rad = 2.0F * std::numbers::pi_v<float>;
/// Azimuth falls back by more than this only where a ring begins. Within a ring it falls back from
/// what is near to what is far, as lasers sit beside the axis of rotation: an HDL-64E's, 0.13 m
/// beside it, by up to 0.14 rad (8 degrees) for what is 0.9 m away, its shortest range.
constexpr float kWrap_rad = 0.3F;
/// A gap is a step of the azimuth of more than this, and of several columns.
constexpr double kGap_rad = 0.035;
constexpr double kGapColumns = 4.0;
/// How far the height must fall across a gap, in beam spacings, to count as a possible wrap.
constexpr double kFallAcrossGap = 0.4;
/// Largest vertical distance between lasers.
constexpr double kLaserApart_m = 0.25;
/// A part of a ring smaller than this is no evidence of a ring of its own.
constexpr double kMinRingShareAfterGap = 0.03;
constexpr int kMinPointsPerBin = 3;

/// A run of points without a wrap or a gap inside.
struct Piece {
  std::size_t first = 0;
  std::size_t end = 0;
  bool begins_with_wrap = false;
};

/// Means of some points of one ring within one bin of azimuth.
struct BinElevation {
  int bin = 0;
  double elevation_rad = 0.0;
  double nearness_per_m = 0.0;  ///< one by the horizontal distance
};

/// +1 if the azimuth rises from point to point, -1 if it falls.
float direction_of_rotation(const std::vector<float>& azimuth_rad, float gap_rad) {
  std::int64_t balance = 0;
  for (std::size_t i = 1; i < azimuth_rad.size(); ++i) {
    const float step_rad = azimuth_rad[i] - azimuth_rad[i - 1];
    if (std::abs(step_rad) < gap_rad) balance += step_rad > 0.0F ? 1 : -1;
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
    if (angle < 0.0F) angle += kCircle_rad;
    if (angle >= kCircle_rad) angle -= kCircle_rad;
    angle_rad.push_back(angle);
  }
  return angle_rad;
}

/// One by the horizontal distance of each point.
std::vector<float> nearness_per_m(const Scan& scan) {
  constexpr float kLeast_m = 0.1F;
  std::vector<float> nearness;
  nearness.reserve(scan.points_m.size());
  for (const Eigen::Vector3f& p : scan.points_m) {
    nearness.push_back(1.0F / std::max(std::sqrt(p.x() * p.x() + p.y() * p.y()), kLeast_m));
  }
  return nearness;
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
std::vector<float> angles_from_ring_begin_rad(const Scan& scan, const std::vector<float>& tangent,
                                              float gap_rad) {
  std::vector<float> azimuth_rad;
  azimuth_rad.reserve(scan.points_m.size());
  for (const Eigen::Vector3f& p : scan.points_m) azimuth_rad.push_back(std::atan2(p.y(), p.x()));
  const float direction = direction_of_rotation(azimuth_rad, gap_rad);
  std::vector<float> from_front = angles_from_seam_rad(azimuth_rad, direction, 0.0F);
  std::vector<float> from_back =
      angles_from_seam_rad(azimuth_rad, direction, std::numbers::pi_v<float>);
  const bool back = fall_across_seam(from_back, tangent) > fall_across_seam(from_front, tangent);
  return back ? from_back : from_front;
}

/// Only gaps cut a turn, into no more pieces than fit into it.
std::vector<Piece> cut_into_pieces(const std::vector<float>& angle_rad, float gap_rad) {
  std::vector<Piece> pieces(1);
  float farthest_rad = angle_rad.front();  // of the turn: near things are ahead of far ones
  for (std::size_t i = 1; i < angle_rad.size(); ++i) {
    const bool wrap = angle_rad[i] - angle_rad[i - 1] < -kWrap_rad;
    const bool gap = angle_rad[i] - farthest_rad >= gap_rad;
    farthest_rad = wrap ? angle_rad[i] : std::max(farthest_rad, angle_rad[i]);
    if (!wrap && !gap) continue;
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
                const std::vector<float>& nearness_per_m, double spacing_rad, double points_per_row)
      : angle_rad_(angle_rad),
        tangent_(tangent),
        nearness_per_m_(nearness_per_m),
        spacing_rad_(spacing_rad),
        min_points_after_gap_(kMinRingShareAfterGap * points_per_row) {}

  std::vector<RingSegment> segments(const std::vector<Piece>& pieces) {
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
    bool sure = false;  ///< of the height
    double elevation_rad = 0.0;
    double height_rad = 0.0;
  };

  std::vector<BinElevation> bins_of(const Piece& piece) const {
    std::vector<BinElevation> bins;
    const auto bin_of = [&](std::size_t i) {
      return std::min(static_cast<int>(angle_rad_[i] / kCircle_rad * kAzimuthBins),
                      kAzimuthBins - 1);
    };
    for (std::size_t i = piece.first; i < piece.end;) {
      const int bin = bin_of(i);
      double sum = 0.0;
      double nearness = 0.0;
      int points = 0;
      for (; i < piece.end && bin_of(i) == bin; ++i, ++points) {
        sum += tangent_[i];
        nearness += nearness_per_m_[i];
      }
      if (points < kMinPointsPerBin) continue;
      bins.push_back({bin, std::atan(sum / points), nearness / points});
    }
    return bins;
  }

  /// Whether some of these bins look at directions in which the height is sure.
  bool is_sure(const std::vector<BinElevation>& bins) const {
    return std::ranges::any_of(bins, [&](const BinElevation& b) { return last_[b.bin].sure; });
  }

  /// Heights from the bins in directions seen before: the sure ones, if there are any.
  std::vector<double> heights_rad(const std::vector<BinElevation>& bins) const {
    const bool sure = is_sure(bins);
    std::vector<double> result;
    for (const BinElevation& b : bins) {
      const LastSeen& last = last_[b.bin];
      if (!last.seen || last.sure != sure) continue;
      result.push_back(last.height_rad + b.elevation_rad - last.elevation_rad);
    }
    return result;
  }

  static std::vector<double> values_of(const std::vector<BinElevation>& bins,
                                       double BinElevation::*value) {
    std::vector<double> result;
    for (const BinElevation& b : bins) result.push_back(b.*value);
    return result;
  }

  /// By how much one laser may see these higher than those, because it sees them nearer.
  static double parallax_rad(const std::vector<BinElevation>& before,
                             const std::vector<BinElevation>& after) {
    const double before_per_m = median(values_of(before, &BinElevation::nearness_per_m));
    const double after_per_m = median(values_of(after, &BinElevation::nearness_per_m));
    return kLaserApart_m * std::abs(before_per_m - after_per_m);
  }

  struct Fall {
    double fall_rad = 0.0;       ///< from the median of what comes before to that of what follows
    double deviation_rad = 0.0;  ///< mean absolute deviation from the two medians
  };

  Fall fall_between(const std::vector<BinElevation>& before,
                    const std::vector<BinElevation>& after) const {
    if (before.empty() || after.empty()) return {};
    // Where nothing was seen before, the fall of the elevation itself must do.
    const bool comparable = is_sure(before) && is_sure(after);
    Fall fall;
    double count = 0.0;
    for (const auto& [bins, sign] : {std::pair(&before, 1.0), std::pair(&after, -1.0)}) {
      const std::vector<double> values =
          comparable ? heights_rad(*bins) : values_of(*bins, &BinElevation::elevation_rad);
      const double middle = median(values);
      for (const double value : values) fall.deviation_rad += std::abs(value - middle);
      fall.fall_rad += sign * middle;
      count += static_cast<double>(values.size());
    }
    fall.deviation_rad /= count;
    if (!comparable) fall.fall_rad -= parallax_rad(before, after);
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
      // Where the rest of the turn is lower than what is before it and both are most even.
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
      add_segment({.first = pieces[begin].first,
                   .end = pieces[cut - 1].end,
                   .begins_with_wrap = pieces[begin].begins_with_wrap},
                  joined(begin, cut));
      begin = cut;
    }
  }

  void add_segment(RingSegment segment, const std::vector<BinElevation>& bins) {
    std::vector<float> values(tangent_.begin() + static_cast<std::ptrdiff_t>(segment.first),
                              tangent_.begin() + static_cast<std::ptrdiff_t>(segment.end));
    segment.elevation_rad = std::atan(median(values));
    values.assign(nearness_per_m_.begin() + static_cast<std::ptrdiff_t>(segment.first),
                  nearness_per_m_.begin() + static_cast<std::ptrdiff_t>(segment.end));
    segment.parallax_rad = kLaserApart_m * median(values);
    segment.is_sure = segments_.empty() || is_sure(bins);
    if (std::vector<double> heights = heights_rad(bins); !heights.empty()) {
      segment.height_rad = median(heights);
    } else if (segments_.empty()) {
      segment.height_rad = segment.elevation_rad;
    } else {
      const RingSegment& last = segments_.back();
      segment.height_rad = last.height_rad + segment.elevation_rad - last.elevation_rad;
    }
    for (const BinElevation& b : bins) {
      last_[b.bin] = {true, segment.is_sure, b.elevation_rad, segment.height_rad};
      segment.looks_to.set(static_cast<std::size_t>(b.bin));
    }
    segments_.push_back(segment);
  }

  const std::vector<float>& angle_rad_;
  const std::vector<float>& tangent_;
  const std::vector<float>& nearness_per_m_;
  double spacing_rad_;
  double min_points_after_gap_;
  std::array<LastSeen, kAzimuthBins> last_;
  std::vector<RingSegment> segments_;
};

}  // namespace

std::vector<float> elevation_tangents(const Scan& scan) {
  std::vector<float> tangent;
  tangent.reserve(scan.points_m.size());
  for (const Eigen::Vector3f& p : scan.points_m) {
    const float horizontal_m = std::sqrt(p.x() * p.x() + p.y() * p.y());
    // Finite whatever the file holds, so that values can be ordered.
    tangent.push_back(std::clamp(p.z() / std::max(horizontal_m, 1e-6F), -1e6F, 1e6F));
  }
  return tangent;
}

std::vector<double> beam_spacing_rad(const SensorModel& sensor) {
  const auto& elevation_rad = sensor.beam_elevation_rad;
  const int rows = sensor.rows();
  if (rows == 1) return {kCircle_rad / 360.0};
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

std::vector<std::size_t> ring_begins(const Scan& scan) {
  const std::size_t points = scan.points_m.size();
  const std::vector<float> angle_rad =
      angles_from_ring_begin_rad(scan, elevation_tangents(scan), static_cast<float>(kGap_rad));
  std::vector<std::size_t> wraps = {0};
  for (std::size_t i = 1; i < points; ++i) {
    if (angle_rad[i] - angle_rad[i - 1] < -kWrap_rad) wraps.push_back(i);
  }
  wraps.push_back(points);
  std::vector<std::size_t> sizes;
  for (std::size_t w = 1; w < wraps.size(); ++w) sizes.push_back(wraps[w] - wraps[w - 1]);
  const auto usual = static_cast<double>(median(sizes));
  std::vector<std::size_t> begins;
  for (std::size_t w = 1; w < wraps.size(); ++w) {
    const auto size = static_cast<double>(wraps[w] - wraps[w - 1]);
    if (size >= kMinRingShareAfterGap * usual) begins.push_back(wraps[w - 1]);
  }
  return begins;
}

std::vector<RingSegment> ring_segments(const Scan& scan, const SensorModel& sensor) {
  const auto gap_rad =
      static_cast<float>(std::max(kGap_rad, kGapColumns * sensor.column_step_rad()));
  const std::vector<float> tangent = elevation_tangents(scan);
  const std::vector<float> angle_rad = angles_from_ring_begin_rad(scan, tangent, gap_rad);
  const double points_per_row = static_cast<double>(scan.points_m.size()) / sensor.rows();
  const std::vector<float> nearness = nearness_per_m(scan);
  HeightTracker tracker(angle_rad, tangent, nearness, median_beam_spacing_rad(sensor),
                        points_per_row);
  return tracker.segments(cut_into_pieces(angle_rad, gap_rad));
}

}  // namespace hqslam::recordings
