#include "facade.h"

#include <algorithm>
#include <cmath>

namespace hqslam::sim {

namespace {

/// Coordinates on a wall: s along it, z up, depth into the house.
class WallFrame {
 public:
  explicit WallFrame(const WallPlace& place)
      : from_(place.from),
        along_((place.to - place.from).normalized()),
        inwards_(-along_.y(), along_.x()) {}
  Eigen::Vector3d point(double s_m, double z_m, double depth_m) const {
    const Eigen::Vector2d at = from_ + s_m * along_ + depth_m * inwards_;
    return {at.x(), at.y(), z_m};
  }

 private:
  Eigen::Vector2d from_;
  Eigen::Vector2d along_;
  Eigen::Vector2d inwards_;
};

struct Rectangle {
  double s0_m;
  double s1_m;
  double z0_m;
  double z1_m;
};

void add_panel(TriangleMesh& mesh, const WallFrame& wall, const Rectangle& r, double depth_m,
               Surface surface) {
  if (r.s1_m - r.s0_m < 1e-3 || r.z1_m - r.z0_m < 1e-3) return;
  add_quad(mesh, wall.point(r.s0_m, r.z0_m, depth_m), wall.point(r.s1_m, r.z0_m, depth_m),
           wall.point(r.s1_m, r.z1_m, depth_m), wall.point(r.s0_m, r.z1_m, depth_m), surface);
}

/// A block that sticks out of the wall (negative depth) or into it.
void add_block(TriangleMesh& mesh, const WallFrame& wall, const Rectangle& r, double depth0_m,
               double depth1_m, Surface surface) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d origin = wall.point(0.0, 0.0, 0.0);
  frame.linear().col(0) = wall.point(1.0, 0.0, 0.0) - origin;
  frame.linear().col(1) = wall.point(0.0, 0.0, 1.0) - origin;
  frame.translation() = origin;
  add_box(mesh, frame, {r.s0_m, depth0_m, r.z0_m}, {r.s1_m, depth1_m, r.z1_m}, surface);
}

/// A hole with its four reveals and what closes it at the back.
void add_opening(TriangleMesh& mesh, const WallFrame& wall, const Rectangle& r, double recess_m,
                 Surface reveal, Surface back) {
  const auto corner = [&](bool right, bool top, double depth_m) {
    return wall.point(right ? r.s1_m : r.s0_m, top ? r.z1_m : r.z0_m, depth_m);
  };
  constexpr std::array<std::array<bool, 4>, 4> kEdges = {{{false, false, true, false},
                                                          {true, false, true, true},
                                                          {true, true, false, true},
                                                          {false, true, false, false}}};
  for (const auto& edge : kEdges) {
    add_quad(mesh, corner(edge[0], edge[1], 0.0), corner(edge[2], edge[3], 0.0),
             corner(edge[2], edge[3], recess_m), corner(edge[0], edge[1], recess_m), reveal);
  }
  add_panel(mesh, wall, r, recess_m, back);
}

/// A slab with a balustrade: solid, or of bars that let most rays through.
void add_balcony(TriangleMesh& mesh, const WallFrame& wall, double s0_m, double s1_m, double z_m,
                 bool solid) {
  constexpr double kReach_m = 1.1;
  const Surface concrete{Material::kConcrete, 170};
  const Surface metal{Material::kMetal, 90};
  add_block(mesh, wall, {s0_m, s1_m, z_m - 0.16, z_m}, -kReach_m, 0.0, concrete);
  if (solid) {
    add_block(mesh, wall, {s0_m, s1_m, z_m, z_m + 0.95}, -kReach_m, -kReach_m + 0.06, concrete);
    add_block(mesh, wall, {s0_m, s0_m + 0.06, z_m, z_m + 0.95}, -kReach_m, 0.0, concrete);
    add_block(mesh, wall, {s1_m - 0.06, s1_m, z_m, z_m + 0.95}, -kReach_m, 0.0, concrete);
    return;
  }
  add_block(mesh, wall, {s0_m, s1_m, z_m + 0.93, z_m + 0.98}, -kReach_m, -kReach_m + 0.05, metal);
  const int bars = std::max(2, static_cast<int>((s1_m - s0_m) / 0.22));
  for (int bar = 0; bar <= bars; ++bar) {
    const double s_m = s0_m + (s1_m - s0_m) * bar / bars;
    add_column(mesh, wall.point(s_m, z_m, -kReach_m + 0.03),
               wall.point(s_m, z_m + 0.95, -kReach_m + 0.03), 0.015, 0.015, 3, metal);
  }
}

struct Openings {
  double width_m;
  double low_m;  ///< above the storey's floor
  double high_m;
};

/// One storey: a strip below the openings, one above, piers between them.
void add_storey(TriangleMesh& mesh, const WallFrame& wall, const Rectangle& storey, int bays,
                const Openings& openings, const FacadeStyle& style, int door_bay, Random& random) {
  const double bay_m = (storey.s1_m - storey.s0_m) / bays;
  const double z0_m = storey.z0_m + openings.low_m;
  const double z1_m = storey.z0_m + openings.high_m;
  add_panel(mesh, wall, {storey.s0_m, storey.s1_m, z1_m, storey.z1_m}, 0.0, style.wall);
  double pier_from_m = storey.s0_m;
  for (int bay = 0; bay < bays; ++bay) {
    const bool door = bay == door_bay;
    const double width_m = door ? 1.1 : std::min(openings.width_m, bay_m - 0.3);
    const double middle_m = storey.s0_m + (bay + 0.5) * bay_m;
    const Rectangle hole{middle_m - 0.5 * width_m, middle_m + 0.5 * width_m,
                         door ? storey.z0_m : z0_m, z1_m};
    add_panel(mesh, wall, {pier_from_m, hole.s0_m, z0_m, z1_m}, 0.0, style.wall);
    const Surface back =
        door ? Surface{Material::kWood, random.shade()} : Surface{Material::kGlass, random.shade()};
    add_opening(mesh, wall, hole, door ? 0.35 : style.recess_m, style.wall, back);
    pier_from_m = hole.s1_m;
    if (!door) {
      add_panel(mesh, wall, {middle_m - 0.5 * bay_m, middle_m + 0.5 * bay_m, storey.z0_m, z0_m},
                0.0, style.wall);
    } else {
      add_panel(mesh, wall, {middle_m - 0.5 * bay_m, hole.s0_m, storey.z0_m, z0_m}, 0.0,
                style.wall);
      add_panel(mesh, wall, {hole.s1_m, middle_m + 0.5 * bay_m, storey.z0_m, z0_m}, 0.0,
                style.wall);
    }
  }
  add_panel(mesh, wall, {pier_from_m, storey.s1_m, z0_m, z1_m}, 0.0, style.wall);
}

/// Two steps up to a door.
void add_steps(TriangleMesh& mesh, const WallFrame& wall, double s_m, const WallPlace& place) {
  const Surface stone{Material::kConcrete, 150};
  add_block(mesh, wall, {s_m - 0.9, s_m + 0.9, place.foot_z_m, place.floor_z_m}, -0.8, 0.0, stone);
  add_block(mesh, wall, {s_m - 0.9, s_m + 0.9, place.foot_z_m, place.floor_z_m - 0.17}, -1.15, -0.8,
            stone);
}

/// A bay that sticks out over the upper storeys, with windows on its front.
void add_oriel(TriangleMesh& mesh, const WallFrame& wall, double s0_m, double s1_m,
               const WallPlace& place, const FacadeStyle& style, Random& random) {
  constexpr double kReach_m = 0.75;
  const double low_m = place.floor_z_m + style.storey_height_m;
  const double high_m = place.floor_z_m + style.storeys * style.storey_height_m - 0.3;
  add_block(mesh, wall, {s0_m, s1_m, low_m, high_m}, -kReach_m, 0.0, style.wall);
  for (int storey = 1; storey < style.storeys; ++storey) {
    const double z_m = place.floor_z_m + storey * style.storey_height_m + 0.8;
    add_panel(mesh, wall, {s0_m + 0.3, s1_m - 0.3, z_m, z_m + style.window_height_m},
              -kReach_m - 0.01, {Material::kGlass, random.shade()});
  }
}

/// A shop's awning over the sidewalk.
void add_awning(TriangleMesh& mesh, const WallFrame& wall, double length_m, double z_m,
                Random& random) {
  add_quad(mesh, wall.point(0.3, z_m + 0.4, 0.0), wall.point(length_m - 0.3, z_m + 0.4, 0.0),
           wall.point(length_m - 0.3, z_m, -1.3), wall.point(0.3, z_m, -1.3),
           {Material::kCloth, random.shade()});
}

/// What sticks out of a front: steps, an oriel, an awning, a gutter pipe.
void add_relief(TriangleMesh& mesh, const WallFrame& wall, const WallPlace& place,
                const FacadeStyle& style, int bays, int door_bay, Random& random) {
  const double length_m = (place.to - place.from).norm();
  const double bay_m = length_m / bays;
  if (door_bay >= 0) add_steps(mesh, wall, (door_bay + 0.5) * bay_m, place);
  if (style.storeys > 1 && random.chance(0.35)) {
    const int bay = random.below(bays);
    add_oriel(mesh, wall, bay * bay_m + 0.1, (bay + 1) * bay_m - 0.1, place, style, random);
  }
  if (style.shop && random.chance(0.5)) {
    add_awning(mesh, wall, length_m, place.floor_z_m + 2.55, random);
  }
  const double eaves_m = place.floor_z_m + style.storeys * style.storey_height_m;
  add_column(mesh, wall.point(0.15, place.foot_z_m, -0.08), wall.point(0.15, eaves_m, -0.08), 0.06,
             0.06, 5, {Material::kMetal, 140});
}

/// Balconies on some bays above the ground storey.
void add_balconies(TriangleMesh& mesh, const WallFrame& wall, const WallPlace& place,
                   const FacadeStyle& style, int bays, Random& random) {
  const double bay_m = (place.to - place.from).norm() / bays;
  const bool solid = random.chance(0.5);
  for (int storey = 1; storey < style.storeys; ++storey) {
    const double z_m = place.floor_z_m + storey * style.storey_height_m;
    for (int bay = 0; bay < bays; ++bay) {
      if (!random.chance(style.balcony_share)) continue;
      add_balcony(mesh, wall, bay * bay_m + 0.2, (bay + 1) * bay_m - 0.2, z_m, solid);
    }
  }
}

}  // namespace

void add_facade(TriangleMesh& mesh, const WallPlace& place, const FacadeStyle& style,
                bool with_door, Random& random) {
  const WallFrame wall(place);
  const double length_m = (place.to - place.from).norm();
  const int bays = std::max(1, static_cast<int>(std::lround(length_m / style.bay_width_m)));
  add_panel(mesh, wall, {0.0, length_m, place.foot_z_m, place.floor_z_m}, 0.0, style.wall);
  const int door_bay = with_door ? random.below(bays) : -1;
  const Openings upper{style.window_width_m, 0.9, 0.9 + style.window_height_m};
  const Openings shop{style.bay_width_m - 0.5, 0.45, 2.6};
  for (int storey = 0; storey < style.storeys; ++storey) {
    const double z_m = place.floor_z_m + storey * style.storey_height_m;
    add_storey(mesh, wall, {0.0, length_m, z_m, z_m + style.storey_height_m}, bays,
               storey == 0 && style.shop ? shop : upper, style, storey == 0 ? door_bay : -1,
               random);
  }
  add_balconies(mesh, wall, place, style, bays, random);
  add_relief(mesh, wall, place, style, bays, door_bay, random);
  const double eaves_m = place.floor_z_m + style.storeys * style.storey_height_m;
  add_block(mesh, wall, {0.0, length_m, eaves_m - 0.25, eaves_m}, -0.25, 0.0, style.wall);
}

void add_blank_wall(TriangleMesh& mesh, const WallPlace& place, const FacadeStyle& style) {
  const double length_m = (place.to - place.from).norm();
  const double eaves_m = place.floor_z_m + style.storeys * style.storey_height_m;
  add_panel(mesh, WallFrame(place), {0.0, length_m, place.foot_z_m, eaves_m}, 0.0, style.wall);
}

}  // namespace hqslam::sim
