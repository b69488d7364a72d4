#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "alignment/rigid_alignment.h"
#include "hqslam/core/median.h"

namespace hqslam::slam {

/// How far a feature is from its plane, or from its line.
inline double distance_m(const PlaneConstraint& plane) {
  return std::abs(plane.normal.dot(plane.point_m) - plane.offset_m);
}
inline double distance_m(const EdgeConstraints& edge) {
  return std::hypot(distance_m(edge[0]), distance_m(edge[1]));
}

inline void weigh(PlaneConstraint& plane, double factor) { plane.weight *= factor; }
inline void weigh(EdgeConstraints& edge, double factor) {
  for (PlaneConstraint& plane : edge) plane.weight *= factor;
}

/// Variance of a feature's distance from its line or plane, and weights that follow from it.
///
/// What the range's noise, the spread of the map's points and the fit of lines and planes to them
/// amount to differs from kind to kind and from place to place: millimetres on a road, decimetres
/// in a meadow. The scan itself is asked, by the median distance m of all features of a kind:
///
///   sigma^2 = (0.02 m)^2 + (2 m)^2,   weight = 1 / sigma.
///
/// Twice the median, not 1.5 times, as it would be for independent Gaussian errors: neighbours err
/// together. Near the pose (`trust_near`) features that lie far from their line or plane lose
/// weight beside.
///
/// Near kerbs, hedges and corners five neighbours are of two surfaces, and the line or plane
/// through them lies centimetres beside both, always on the same side: scan after scan is pulled
/// the same way. So a feature at a distance d is weighed with
///
///   1 / (1 + d^2 / s^2),  s = max(trusted_m, 3 m),
///
/// the loss of Geman and McClure by iterated reweighting. The median lets all features pull while
/// the pose is still off. LOAM and LeGO-LOAM only take 0.9 d from a weight of 1.
template <typename Constraints>
void weigh_by_noise(std::vector<std::optional<Constraints>>& found, double trusted_m,
                    bool trust_near) {
  constexpr double kScalePerMedian = 3.0;
  constexpr double kLeastSigma_m = 0.02;
  constexpr double kSigmaPerMedian = 2.0;
  std::vector<double> distances_m;
  distances_m.reserve(found.size());
  for (const auto& constraints : found) {
    if (constraints) distances_m.push_back(distance_m(*constraints));
  }
  if (distances_m.empty()) return;
  const double median_m = median(distances_m);
  const double scale_m = std::max(trusted_m, kScalePerMedian * median_m);
  const double sigma_m = std::hypot(kLeastSigma_m, kSigmaPerMedian * median_m);
  auto away_m = distances_m.begin();
  for (auto& constraints : found) {
    if (!constraints) continue;
    const double relative = trust_near ? *away_m++ / scale_m : 0.0;
    weigh(*constraints, 1.0 / (1.0 + relative * relative) / sigma_m);
  }
}

}  // namespace hqslam::slam
