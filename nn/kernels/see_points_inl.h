// Where points of the world are in the frame of a sensor that moves; included as row_kernels_inl.h
// is.

#include "row_kernels.h"
#include "vector_math_inl.h"

namespace hqslam::nn::kernels {
namespace {

struct PointVectors {
  Vector x, y, z;
};

inline PointVectors seen_from(const SeePoints& points, int i, Vector h) {
  const auto element = [&](int e) {
    const float(&term)[4] = points.motion[e];
    return ((term[3] * h + term[2]) * h + term[1]) * h + term[0];
  };
  const Vector x = load(points.x_m + i) - element(9);
  const Vector y = load(points.y_m + i) - element(10);
  const Vector z = load(points.z_m + i) - element(11);
  const auto row = [&](int r) {
    return element(3 * r) * x + element(3 * r + 1) * y + element(3 * r + 2) * z;
  };
  return {row(0), row(1), row(2)};
}

void see_points(const SeePoints& points) {
  const float per_rad = points.columns * 0.159154943F;
  for (int i = 0; i < points.count; i += kVectorFloats) {
    Vector h = {};
    PointVectors p = {};
    Vector turn = {};
    for (int step = 0; step < 3; ++step) {
      p = seen_from(points, i, h);
      turn = arc_tangent(p.y, p.x) * per_rad;
      const Vector head = load(points.head_offset + i) - turn - points.first_column;
      const Vector h_once = head * (2.0F / points.columns) - 1.0F;
      h = h_once < -1.0F ? h_once + 2.0F : h_once > 1.0F ? h_once - 2.0F : h_once;
    }
    const Vector square_m2 = p.x * p.x + p.y * p.y + p.z * p.z;
    const Vector per_m = reciprocal_root(square_m2);
    store(points.range_m + i, square_m2 * per_m);
    store(points.sine + i, p.z * per_m);
    store(points.turn + i, turn);
  }
}

}  // namespace
}  // namespace hqslam::nn::kernels
