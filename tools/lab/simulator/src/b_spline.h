#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace hqslam::sim {

/// A point of a curve and its first derivative by the parameter.
template <typename Vector>
struct SplineValue {
  Vector position;
  Vector derivative;
};

/// Uniform cubic B-spline of at least four control points: one unit of the parameter leads from
/// one control point to the next; 0 is near the second one.
template <typename Vector>
SplineValue<Vector> spline_at(const std::vector<Vector>& control, double parameter) {
  const double last = static_cast<double>(control.size()) - 3.0;
  const double clamped = std::clamp(parameter, 0.0, last - 1e-9);
  const auto first = static_cast<std::size_t>(clamped);
  const double t = clamped - static_cast<double>(first);
  const double s = 1.0 - t;
  const Vector& a = control[first];
  const Vector& b = control[first + 1];
  const Vector& c = control[first + 2];
  const Vector& d = control[first + 3];
  SplineValue<Vector> value;
  value.position = (s * s * s * a + (3.0 * t * t * t - 6.0 * t * t + 4.0) * b +
                    (3.0 * s * s * s - 6.0 * s * s + 4.0) * c + t * t * t * d) /
                   6.0;
  value.derivative = 0.5 * (s * s * (b - a) + (1.0 + 2.0 * s * t) * (c - b) + t * t * (d - c));
  return value;
}

/// A polyline with points at equal distances along it, and the leg of each point.
template <typename Vector>
struct Resampled {
  std::vector<Vector> points;
  std::vector<std::size_t> legs;
};
template <typename Vector>
Resampled<Vector> resampled(const std::vector<Vector>& corners, double spacing) {
  Resampled<Vector> result;
  double until_next = 0.0;
  for (std::size_t leg = 0; leg + 1 < corners.size(); ++leg) {
    const Vector step = corners[leg + 1] - corners[leg];
    const double length = step.norm();
    for (; until_next < length; until_next += spacing) {
      result.points.push_back(corners[leg] + step * (until_next / length));
      result.legs.push_back(leg);
    }
    until_next -= length;
  }
  return result;
}

/// Rounds the corners of a row of points; the first and the last stay.
template <typename Vector>
void smooth(std::vector<Vector>& points, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    Vector previous = points.front();
    for (std::size_t k = 1; k + 1 < points.size(); ++k) {
      const Vector here = points[k];
      points[k] = 0.25 * previous + 0.5 * here + 0.25 * points[k + 1];
      previous = here;
    }
  }
}

}  // namespace hqslam::sim
