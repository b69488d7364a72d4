#include "points/time_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <complex>
#include <utility>

#include "hqslam/core/angles.h"

namespace hqslam::recordings {

namespace {

/// Half a turn of the fastest sensors, which turn twenty times a second.
constexpr double kLeastTurn_s = 0.025;
/// Of a turn's twelfths, those in which points that go all around are.
constexpr std::size_t kTwelfths = 12;
constexpr std::size_t kAllAround = 11;
/// Mean resultant lengths (1: all angles alike) of directions that are and are not those of a turn.
constexpr double kAlike = 0.8;
constexpr double kUnlike = 0.5;

double azimuth_rad(const Eigen::Vector3f& point_m) { return std::atan2(point_m.y(), point_m.x()); }

bool goes_all_around(const Scan& scan) {
  std::bitset<kTwelfths> seen;
  for (const Eigen::Vector3f& point_m : scan.points_m) {
    const double turned = azimuth_rad(point_m) / kTwoPi + 0.5;
    seen.set(std::min(static_cast<std::size_t>(turned * kTwelfths), kTwelfths - 1));
  }
  return seen.count() >= kAllAround;
}

double span_s(const Scan& scan) {
  const auto [first, last] = std::ranges::minmax_element(scan.time_offset_s);
  return *last - *first;
}

/// "" where the times are possible; otherwise they are removed.
std::string remove_impossible_times(Scan& scan) {
  const double span = span_s(scan);
  if (span >= kLeastTurn_s || !goes_all_around(scan)) return "";
  scan.time_offset_s.clear();
  return fmt::format(
      "expected at least {} s for the turn that the points make, found times within {:.2g} s: the "
      "points are taken as without times",
      kLeastTurn_s, span);
}

bool is_counterclockwise(const Scan& scan, double turn_s) {
  const auto alike = [&](double sign) {
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < scan.time_offset_s.size(); ++i) {
      const double turned_rad = kTwoPi * scan.time_offset_s[i] / turn_s;
      sum += std::polar(1.0, azimuth_rad(scan.points_m[i]) + sign * turned_rad);
    }
    return std::abs(sum) / static_cast<double>(scan.time_offset_s.size());
  };
  return goes_all_around(scan) && alike(-1.0) > kAlike && alike(1.0) < kUnlike;
}

}  // namespace

std::string TimeCheck::check(Scan& scan, double turn_s) {
  if (scan.time_offset_s.empty()) return "";
  const bool is_first = !std::exchange(has_begun_, true);
  std::string text = remove_impossible_times(scan);
  if (is_first && text.empty() && is_counterclockwise(scan, turn_s)) {
    text =
        "the points' times rise counterclockwise, but sensors turn clockwise seen from above: they "
        "may be reversed";
  }
  return text.empty() || std::exchange(has_warned_, true) ? "" : text;
}

}  // namespace hqslam::recordings
