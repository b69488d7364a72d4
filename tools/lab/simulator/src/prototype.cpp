#include "prototype.h"

#include <array>
#include <cmath>
#include <numbers>

#include "random.h"

namespace hqslam::sim {

namespace {

/// A direction of the unit sphere, by rejection.
Eigen::Vector3d draw_direction(Random& random) {
  while (true) {
    Eigen::Vector3d candidate;
    candidate.z() = random.uniform(-1.0, 1.0);
    candidate.y() = random.uniform(-1.0, 1.0);
    candidate.x() = random.uniform(-1.0, 1.0);
    const double length = candidate.norm();
    if (length > 0.1 && length < 1.0) return candidate / length;
  }
}

/// A tuft of leaves in a random orientation.
void add_leaf(TriangleMesh& mesh, const Eigen::Vector3d& middle, double half_size_m,
              Random& random) {
  const Eigen::Vector3d normal = draw_direction(random);
  const Eigen::Vector3d a = half_size_m * normal.unitOrthogonal();
  const Eigen::Vector3d b = random.uniform(0.5, 1.0) * normal.cross(a);
  const Surface surface{Material::kFoliage, random.shade()};
  add_quad(mesh, middle - a, middle - b, middle + a, middle + b, surface);
}

/// Leaves in an ellipsoid, denser towards its skin, as light makes them.
void add_foliage(TriangleMesh& mesh, const Eigen::Vector3d& middle,
                 const Eigen::Vector3d& half_axes_m, int leaves, double leaf_half_size_m,
                 Random& random) {
  for (int leaf = 0; leaf < leaves; ++leaf) {
    const double share = std::sqrt(random.uniform(0.12, 1.0));
    const Eigen::Vector3d at = middle + share * draw_direction(random).cwiseProduct(half_axes_m);
    add_leaf(mesh, at, leaf_half_size_m * random.uniform(0.7, 1.3), random);
  }
}

TriangleMesh make_broadleaf(Random& random) {
  TriangleMesh mesh;
  const double trunk_m = random.uniform(2.2, 3.4);
  const double crown_radius_m = random.uniform(1.5, 3.4);
  const double crown_half_height_m = crown_radius_m * random.uniform(0.9, 1.5);
  const double trunk_radius_m = 0.06 * crown_radius_m + random.uniform(0.02, 0.08);
  const Surface bark{Material::kBark, random.shade()};
  const double fork_y_m = random.uniform(-0.3, 0.3);
  const double fork_x_m = random.uniform(-0.3, 0.3);
  const Eigen::Vector3d fork(fork_x_m, fork_y_m, trunk_m);
  add_column(mesh, {0.0, 0.0, -0.6}, fork, trunk_radius_m, 0.75 * trunk_radius_m, 7, bark);
  const Eigen::Vector3d middle = fork + Eigen::Vector3d(0.0, 0.0, 0.75 * crown_half_height_m);
  const int lobes = 5 + random.below(4);
  for (int lobe = 0; lobe < lobes; ++lobe) {
    // The crown is made of lobes at the ends of branches, with gaps between them.
    const double angle_rad = 2.0 * std::numbers::pi * (lobe + random.uniform(0.0, 0.6)) / lobes;
    const double out_m = 0.5 * crown_radius_m * random.uniform(0.7, 1.1);
    const Eigen::Vector3d tip =
        middle + Eigen::Vector3d(out_m * std::cos(angle_rad), out_m * std::sin(angle_rad),
                                 crown_half_height_m * random.uniform(-0.5, 0.6));
    add_column(mesh, fork, tip, 0.5 * trunk_radius_m, 0.02, 4, bark);
    const double lobe_radius_m = 0.55 * crown_radius_m * random.uniform(0.8, 1.15);
    add_foliage(mesh, tip, {lobe_radius_m, lobe_radius_m, 0.9 * lobe_radius_m},
                static_cast<int>(55.0 * lobe_radius_m * lobe_radius_m), 0.16, random);
  }
  add_column(mesh, fork, middle + Eigen::Vector3d(0.0, 0.0, 0.5 * crown_half_height_m),
             0.6 * trunk_radius_m, 0.02, 4, bark);
  add_foliage(mesh, middle + Eigen::Vector3d(0.0, 0.0, 0.35 * crown_half_height_m),
              {0.6 * crown_radius_m, 0.6 * crown_radius_m, 0.65 * crown_half_height_m},
              static_cast<int>(50.0 * crown_radius_m * crown_radius_m), 0.16, random);
  return mesh;
}

/// A slim tree: foliage from near the ground to the tip.
TriangleMesh make_conifer(Random& random) {
  TriangleMesh mesh;
  const double height_m = random.uniform(5.0, 9.0);
  const double foot_m = random.uniform(0.4, 1.4);
  const double radius_m = height_m * random.uniform(0.14, 0.24);
  add_column(mesh, {0.0, 0.0, -0.6}, {0.0, 0.0, 0.95 * height_m}, 0.14, 0.03, 6,
             {Material::kBark, random.shade()});
  constexpr int kTiers = 9;
  for (int tier = 0; tier < kTiers; ++tier) {
    const double up = (tier + 0.5) / kTiers;
    const double tier_m = radius_m * (1.05 - up);
    add_foliage(mesh, {0.0, 0.0, foot_m + up * (height_m - foot_m)},
                {tier_m, tier_m, 0.8 * (height_m - foot_m) / kTiers},
                static_cast<int>(70.0 * tier_m * tier_m) + 20, 0.13, random);
  }
  return mesh;
}

/// A car from the side: lower body, then the glasshouse on top.
struct CarShape {
  double half_length_m;
  double half_width_m;
  double belt_m;  ///< height of the bonnet and of the lower edge of the windows
  double roof_m;
  double windscreen_foot_m;  ///< along x
  double windscreen_top_m;
  double rear_top_m;
  double rear_foot_m;
};

constexpr std::array<CarShape, kCarBodies> kCarShapes = {{
    {2.0, 0.87, 0.92, 1.47, 0.95, 0.25, -1.45, -1.9},
    {2.3, 0.90, 0.92, 1.45, 0.90, 0.15, -1.05, -1.65},
    {2.25, 0.93, 1.05, 1.70, 0.95, 0.40, -1.85, -2.15},
    {2.6, 0.98, 1.10, 2.15, 1.75, 1.20, -2.50, -2.58},
}};

/// A prism whose top is narrower: corners in x given per level.
void add_frustum(TriangleMesh& mesh, const std::array<double, 2>& low_x,
                 const std::array<double, 2>& high_x, double low_half_width, double high_half_width,
                 double low_z, double high_z, Surface sides, Surface top) {
  const auto corner = [&](bool high, bool front, bool left) {
    const double half_width = high ? high_half_width : low_half_width;
    return Eigen::Vector3d(high ? high_x[front] : low_x[front], left ? half_width : -half_width,
                           high ? high_z : low_z);
  };
  for (const bool left : {false, true}) {
    add_quad(mesh, corner(false, false, left), corner(false, true, left), corner(true, true, left),
             corner(true, false, left), sides);
  }
  for (const bool front : {false, true}) {
    add_quad(mesh, corner(false, front, false), corner(false, front, true),
             corner(true, front, true), corner(true, front, false), sides);
  }
  add_quad(mesh, corner(true, false, false), corner(true, true, false), corner(true, true, true),
           corner(true, false, true), top);
}

/// About a metre high.
TriangleMesh make_bush(std::uint64_t seed) {
  Random random(seed);
  TriangleMesh mesh;
  const double radius_m = random.uniform(0.4, 0.8);
  add_foliage(mesh, {0.0, 0.0, 0.7 * radius_m}, {radius_m, radius_m, 0.8 * radius_m}, 160, 0.09,
              random);
  return mesh;
}

TriangleMesh make_car(int body) {
  const CarShape& shape = kCarShapes[static_cast<std::size_t>(body)];
  TriangleMesh mesh;
  const Surface paint{Material::kCarPaint, 128};
  const double l = shape.half_length_m;
  const double w = shape.half_width_m;
  add_frustum(mesh, {-l + 0.08, l - 0.1}, {-l, l}, 0.94 * w, w, 0.2, 0.55, paint, paint);
  add_frustum(mesh, {-l, l}, {-l + 0.1, l - 0.25}, w, 0.95 * w, 0.55, shape.belt_m - 0.08, paint,
              paint);
  add_frustum(mesh, {-l + 0.1, l - 0.25}, {shape.rear_foot_m, shape.windscreen_foot_m}, 0.95 * w,
              0.92 * w, shape.belt_m - 0.08, shape.belt_m, paint, paint);
  add_frustum(mesh, {shape.rear_foot_m, shape.windscreen_foot_m},
              {shape.rear_top_m, shape.windscreen_top_m}, 0.9 * w, 0.72 * w, shape.belt_m,
              shape.roof_m, {Material::kCarGlass, 128}, paint);
  // Pillars between the windows.
  for (const double y : {-0.86 * w, 0.86 * w}) {
    add_column(mesh, {-0.35, y, shape.belt_m - 0.05}, {-0.35, 0.84 * y, shape.roof_m}, 0.06, 0.05,
               4, paint);
  }
  add_quad(mesh, {-l + 0.1, -w, 0.22}, {l - 0.1, -w, 0.22}, {l - 0.1, w, 0.22}, {-l + 0.1, w, 0.22},
           {Material::kRubber, 128});
  for (const double x : {-0.62 * l, 0.64 * l}) {
    for (const double side : {-1.0, 1.0}) {
      add_column(mesh, {x, side * (w - 0.2), 0.31}, {x, side * (w + 0.01), 0.31}, 0.31, 0.31, 9,
                 {Material::kRubber, 128});
    }
  }
  const auto here = Eigen::Isometry3d::Identity();
  const Part plates{mesh, here, {Material::kRetroreflector, 60}};
  for (const double end : {-l - 0.01, l + 0.01}) {
    plates.box({end - 0.01, -0.26, 0.42}, {end + 0.01, 0.26, 0.53});
  }
  const Part mirrors{mesh, here, paint};
  for (const bool left : {false, true}) {
    mirrors.box({shape.windscreen_foot_m - 0.25, left ? w : -w - 0.16, shape.belt_m},
                {shape.windscreen_foot_m - 0.12, left ? w + 0.16 : -w, shape.belt_m + 0.13});
  }
  return mesh;
}

TriangleMesh make_walker(int body) {
  TriangleMesh mesh;
  const Surface cloth{Material::kCloth, 128};
  const double size = body == 0 ? 1.0 : 0.93;
  const double stride_m = body == 0 ? 0.28 : 0.16;
  const auto limb = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to, double from_m,
                        double to_m) {
    add_column(mesh, size * from, size * to, size * from_m, size * to_m, 6, cloth);
  };
  limb({stride_m, 0.1, 0.0}, {0.0, 0.09, 0.86}, 0.06, 0.09);
  limb({-stride_m, -0.1, 0.0}, {0.0, -0.09, 0.86}, 0.06, 0.09);
  limb({0.0, 0.0, 0.82}, {0.02, 0.0, 1.46}, 0.17, 0.19);
  limb({0.02, 0.0, 1.46}, {0.03, 0.0, 1.56}, 0.07, 0.06);
  limb({0.03, 0.0, 1.53}, {0.04, 0.0, 1.78}, 0.10, 0.09);
  limb({0.0, 0.23, 1.42}, {-0.18, 0.26, 0.86}, 0.05, 0.04);
  limb({0.0, -0.23, 1.42}, {0.2, -0.26, 0.88}, 0.05, 0.04);
  return mesh;
}

/// Broadleaf or conifer: trunk, branches and a crown of single leaf quads, so that some rays pass
/// between them.
TriangleMesh make_tree(std::uint64_t seed) {
  Random random(seed);
  return random.chance(0.3) ? make_conifer(random) : make_broadleaf(random);
}

}  // namespace

std::vector<TriangleMesh> make_prototypes(std::uint64_t seed) {
  std::vector<TriangleMesh> prototypes;
  for (int shape = 0; shape < kTreeShapes; ++shape) {
    prototypes.push_back(make_tree(seed_of(seed, 1, static_cast<std::uint64_t>(shape))));
  }
  for (int shape = 0; shape < kBushShapes; ++shape) {
    prototypes.push_back(make_bush(seed_of(seed, 2, static_cast<std::uint64_t>(shape))));
  }
  for (int body = 0; body < kCarBodies; ++body) prototypes.push_back(make_car(body));
  for (int body = 0; body < kWalkerBodies; ++body) prototypes.push_back(make_walker(body));
  return prototypes;
}

}  // namespace hqslam::sim
