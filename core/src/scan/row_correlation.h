#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

namespace hqslam {

/// Pearson's correlation of the points' rows, or ring numbers, with the sine of their elevations:
/// near -1 where row 0 is the highest beam, near 1 where it is the lowest; 0 where either does not
/// vary. As many rows as points; those at the origin or not finite do not count.
template <typename Row>
double correlation_with_elevation(const std::vector<Row>& row,
                                  const std::vector<Eigen::Vector3f>& points_m) {
  double n = 0.0, sum_r = 0.0, sum_e = 0.0, sum_rr = 0.0, sum_ee = 0.0, sum_re = 0.0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const Eigen::Vector3d point_m = points_m[i].template cast<double>();
    const double level_m2 = point_m.x() * point_m.x() + point_m.y() * point_m.y();
    const double r = row[i];
    const double e = point_m.z() / std::sqrt(level_m2 + point_m.z() * point_m.z());
    if (!std::isfinite(e)) continue;
    n += 1.0;
    sum_r += r;
    sum_e += e;
    sum_rr += r * r;
    sum_ee += e * e;
    sum_re += r * e;
  }
  const double variance_r = sum_rr - sum_r * sum_r / n;
  const double variance_e = sum_ee - sum_e * sum_e / n;
  if (!(variance_r > 1e-9 * n) || !(variance_e > 1e-12 * n)) return 0.0;
  return (sum_re - sum_r * sum_e / n) / std::sqrt(variance_r * variance_e);
}

}  // namespace hqslam
