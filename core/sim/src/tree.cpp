#include <cmath>
#include <numbers>

#include "prototype.h"
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

/// A tuft of leaves; real ones point every way.
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

}  // namespace

TriangleMesh make_tree(std::uint64_t seed) {
  Random random(seed);
  return random.chance(0.3) ? make_conifer(random) : make_broadleaf(random);
}

TriangleMesh make_bush(std::uint64_t seed) {
  Random random(seed);
  TriangleMesh mesh;
  const double radius_m = random.uniform(0.4, 0.8);
  add_foliage(mesh, {0.0, 0.0, 0.7 * radius_m}, {radius_m, radius_m, 0.8 * radius_m}, 160, 0.09,
              random);
  return mesh;
}

}  // namespace hqslam::sim
