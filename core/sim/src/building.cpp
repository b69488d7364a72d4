#include <algorithm>
#include <limits>

#include "block_contents.h"
#include "facade.h"

namespace hqslam::sim {

namespace {

FacadeStyle draw_style(const HouseLot& lot, Random& random) {
  FacadeStyle style;
  style.storey_height_m = random.uniform(2.8, 3.4);
  style.storeys = lot.detached ? 1 + random.below(2) : 2 + random.below(4);
  style.bay_width_m = random.uniform(2.3, 3.6);
  style.window_width_m = random.uniform(0.9, 1.5);
  style.window_height_m = random.uniform(1.2, 1.7);
  style.recess_m = random.uniform(0.1, 0.32);
  style.balcony_share = random.chance(0.35) ? 0.4 : 0.0;
  style.shop = !lot.detached && random.chance(0.3);
  style.wall = {random.chance(0.8) ? Material::kPlaster : Material::kWood, random.shade()};
  return style;
}

using Corners = std::array<Eigen::Vector2d, 4>;

Eigen::Vector3d at_height(const Eigen::Vector2d& position_m, double z_m) {
  return {position_m.x(), position_m.y(), z_m};
}

/// A flat roof with a chimney, sunk a little behind the parapet.
void add_flat_roof(TriangleMesh& mesh, const Corners& corner, double eaves_m, Random& random) {
  const Surface roof{Material::kRoof, random.shade()};
  const double z_m = eaves_m - 0.3;
  add_quad(mesh, at_height(corner[0], z_m), at_height(corner[1], z_m), at_height(corner[2], z_m),
           at_height(corner[3], z_m), roof);
  const Eigen::Vector2d place = corner[0] + random.uniform(0.2, 0.7) * (corner[2] - corner[0]);
  const Surface plaster{Material::kPlaster, random.shade()};
  Eigen::Vector3d chimney_m;
  chimney_m.x() = random.uniform(0.5, 1.5);
  chimney_m.y() = random.uniform(0.5, 1.0);
  chimney_m.z() = random.uniform(0.8, 1.6);
  add_box(mesh, upright_frame(at_height(place, z_m), 0.0), {0.0, 0.0, 0.0}, chimney_m, plaster);
}

/// Two slopes; the ridge runs along the front.
void add_gabled_roof(TriangleMesh& mesh, const Corners& corner, int front, double eaves_m,
                     Surface wall, Random& random) {
  const Surface roof{Material::kRoof, random.shade()};
  const auto k = static_cast<std::size_t>(front);
  const std::array<Eigen::Vector2d, 4> c = {corner[k], corner[(k + 1) % 4], corner[(k + 2) % 4],
                                            corner[(k + 3) % 4]};
  const double rise_m = 0.5 * (c[3] - c[0]).norm() * random.uniform(0.5, 0.9);
  const Eigen::Vector3d left = at_height(0.5 * (c[0] + c[3]), eaves_m + rise_m);
  const Eigen::Vector3d right = at_height(0.5 * (c[1] + c[2]), eaves_m + rise_m);
  add_triangle(mesh, at_height(c[0], eaves_m), at_height(c[3], eaves_m), left, wall);
  add_triangle(mesh, at_height(c[1], eaves_m), at_height(c[2], eaves_m), right, wall);
  // The slopes overhang the walls.
  const auto eave = [&](const Eigen::Vector2d& foot, const Eigen::Vector3d& ridge) {
    const Eigen::Vector3d top = at_height(foot, eaves_m);
    return Eigen::Vector3d(top + 0.12 * (top - ridge));
  };
  add_quad(mesh, eave(c[0], left), eave(c[1], right), right, left, roof);
  add_quad(mesh, eave(c[3], left), eave(c[2], right), right, left, roof);
}

}  // namespace

void add_house(City& city, const HouseLot& lot, Random& random) {
  const FacadeStyle style = draw_style(lot, random);
  Corners corner;
  double lowest_m = std::numeric_limits<double>::infinity();
  double highest_m = -lowest_m;
  for (std::size_t k = 0; k < 4; ++k) {
    corner[k] = city.layout.plane(sides_of(lot.sheet_m)[k].from_m);
    lowest_m = std::min(lowest_m, city.layout.terrain.height_m(corner[k]));
    highest_m = std::max(highest_m, city.layout.terrain.height_m(corner[k]));
  }
  const double floor_m = 0.5 * (lowest_m + highest_m) + kKerbHeight_m + 0.1;
  for (std::size_t side = 0; side < 4; ++side) {
    const WallPlace place{corner[side], corner[(side + 1) % 4], lowest_m - 0.5, floor_m};
    if (lot.open_to_view[side]) {
      add_facade(city.fixed, place, style, static_cast<int>(side) == lot.front, random);
    } else {
      add_blank_wall(city.fixed, place, style);
    }
  }
  const double eaves_m = floor_m + style.storeys * style.storey_height_m;
  if (lot.detached || random.chance(0.2)) {
    add_gabled_roof(city.fixed, corner, lot.front, eaves_m, style.wall, random);
  } else {
    add_flat_roof(city.fixed, corner, eaves_m, random);
  }
}

}  // namespace hqslam::sim
