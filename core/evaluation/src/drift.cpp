#include "hqslam/evaluation/drift.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <optional>

#include "hqslam/core/error.h"
#include "motion_error.h"

namespace hqslam {

namespace {

void validate(const SlipOptions& options) {
  if (options.scans > 0 && options.translation_m > 0.0 && options.rotation_rad > 0.0) return;
  throw Error(
      fmt::format("slips: expected a positive number of scans and positive limits, found "
                  "{}, {} m and {} rad",
                  options.scans, options.translation_m, options.rotation_rad));
}

/// Per reference pose the index of the estimate's pose at its time.
std::vector<std::optional<std::size_t>> partners(const PosePairs& pairs, std::size_t poses) {
  std::vector<std::optional<std::size_t>> result(poses);
  for (std::size_t i = 0; i < pairs.reference.size(); ++i) {
    result[pairs.reference[i]] = pairs.estimate[i];
  }
  return result;
}

bool touches(const Slip& slip, std::size_t first, std::size_t last) {
  return slip.first <= last && first <= slip.last;
}

}  // namespace

std::vector<Slip> slips(const Trajectory& estimate, const Trajectory& reference,
                        const SlipOptions& options, double max_difference_s) {
  validate(options);
  const PosePairs pairs = associate(estimate, reference, max_difference_s);
  require_pairs(pairs, 2, max_difference_s);
  const auto partner = partners(pairs, reference.size());
  std::vector<Slip> result;
  for (std::size_t i = 0; i + options.scans < reference.size(); ++i) {
    const std::size_t j = i + options.scans;
    if (!partner[i] || !partner[j]) continue;
    const Pose difference =
        motion_error({estimate[*partner[i]].T_map_sensor, estimate[*partner[j]].T_map_sensor},
                     {reference[i].T_map_sensor, reference[j].T_map_sensor});
    const double translation_m = difference.translation().norm();
    const double rotation_rad = rotation_angle_rad(difference);
    // Written so that a pose that is not a number is a slip.
    if (translation_m <= options.translation_m && rotation_rad <= options.rotation_rad) continue;
    if (result.empty() || i > result.back().last + 1) result.push_back({i, j, 0.0, 0.0});
    Slip& slip = result.back();
    slip.last = j;
    slip.translation_m = std::max(slip.translation_m, translation_m);
    slip.rotation_rad = std::max(slip.rotation_rad, rotation_rad);
  }
  return result;
}

double slips_per_100_km(std::size_t slips, double path_m) {
  constexpr double kMetres = 100e3;
  return path_m > 0.0 ? kMetres * static_cast<double>(slips) / path_m : 0.0;
}

Drift drift(const RelativePoseError& error, const std::vector<Slip>& left_out) {
  Drift result;
  for (std::size_t i = 0; i < error.translation_m.size(); ++i) {
    const bool slipped = std::any_of(left_out.begin(), left_out.end(), [&](const Slip& slip) {
      return touches(slip, error.first[i], error.last[i]);
    });
    if (slipped) continue;
    ++result.pieces;
    result.translation_percent += 100.0 * error.translation_m[i] / error.stretch_m;
    result.rotation_deg_per_100m +=
        100.0 * error.rotation_rad[i] * 180.0 / std::numbers::pi / error.stretch_m;
  }
  if (result.pieces > 0) {
    result.translation_percent /= static_cast<double>(result.pieces);
    result.rotation_deg_per_100m /= static_cast<double>(result.pieces);
  }
  return result;
}

}  // namespace hqslam
