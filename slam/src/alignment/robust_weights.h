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
/// The sum of range noise, spread of the map's points and error of the fitted lines and planes
/// differs between kinds of features and places: millimetres on a road, decimetres in a meadow. It
/// is estimated from the scan itself, by the median distance m of all features of a kind:
///
///   sigma^2 = (0.02 m)^2 + (2 m)^2,   weight = 1 / sigma.
///
/// The factor is 2, not 1.5 as for independent Gaussian errors, since errors of neighbours are
/// correlated. Near the pose (`trust_near`) features far from their line or plane lose weight:
/// near kerbs, hedges and corners five neighbours are of two surfaces, and the line or plane
/// through them is centimetres beside both, always on the same side, which would bias scan after
/// scan. The weight of a feature at a distance d is multiplied by
///
///   1 / (1 + d^2 / s^2),  s = max(trusted_m, 3 m),
///
/// the loss of Geman and McClure by iterated reweighting. The median keeps the weight of all
/// features while the pose is still wrong. LOAM and LeGO-LOAM subtract 0.9 d from a weight of 1.
template <typename Constraints>
void weigh_by_noise(std::vector<std::optional<Constraints>>& found, double trusted_m,
                    bool trust_near) {
  constexpr double kScalePerMedian = 3.0;  // chosen on simulated hills alone
  // Chosen on simulated hills, checked on KITTI drive 0005.
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
