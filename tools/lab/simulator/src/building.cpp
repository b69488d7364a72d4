#include <algorithm>
#include <cmath>
#include <limits>

#include "block_contents.h"

namespace hqslam::sim {

namespace {

/// The style of all walls of a house.
struct FacadeStyle {
  double storey_height_m = 3.0;
  int storeys = 3;
  double bay_width_m = 2.8;  ///< one window per bay and storey
  double window_width_m = 1.2;
  double window_height_m = 1.5;
  double recess_m = 0.2;       ///< of windows behind the wall
  double balcony_share = 0.1;  ///< of the bays above the ground storey
  bool shop = false;           ///< large windows on the ground storey
  Surface wall;
};

/// A wall from foot `from` to foot `to` (seen from outside: left to right), vertical.
struct WallPlace {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
  double foot_z_m = 0.0;   ///< where the wall leaves the ground, below the lowest point
  double floor_z_m = 0.0;  ///< of the ground storey
};

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

struct Rectangle {
  double s0_m;
  double s1_m;
  double z0_m;
  double z1_m;
};

/// A wall that is being built. Coordinates on it: s along it from its left end, z up, depth into
/// the house (negative: in front of it).
class Wall {
 public:
  Wall(TriangleMesh& mesh, const WallPlace& place, const FacadeStyle& style)
      : mesh_(mesh),
        place_(place),
        style_(style),
        length_m_((place.to - place.from).norm()),
        bays_(std::max(1, static_cast<int>(std::lround(length_m_ / style.bay_width_m)))),
        bay_m_(length_m_ / bays_),
        along_((place.to - place.from).normalized()),
        inwards_(-along_.y(), along_.x()),
        frame_(Eigen::Isometry3d::Identity()) {
    frame_.translation() = point(0.0, 0.0, 0.0);
    frame_.linear().col(0) = point(1.0, 0.0, 0.0) - frame_.translation();
    frame_.linear().col(1) = point(0.0, 0.0, 1.0) - frame_.translation();
  }

  void add_blank() {
    add_panel({0.0, length_m_, place_.foot_z_m, floor_z_m(style_.storeys)}, 0.0, style_.wall);
  }

  void add_facade(bool with_door, Random& random) {
    add_panel({0.0, length_m_, place_.foot_z_m, place_.floor_z_m}, 0.0, style_.wall);
    const int door_bay = with_door ? random.below(bays_) : -1;
    for (int storey = 0; storey < style_.storeys; ++storey) {
      add_storey(storey, storey == 0 ? door_bay : -1, random);
    }
    add_balconies(random);
    add_relief(door_bay, random);
    const double eaves_m = floor_z_m(style_.storeys);
    add_block({0.0, length_m_, eaves_m - 0.25, eaves_m}, -0.25, 0.0, style_.wall);
  }

 private:
  Eigen::Vector3d point(double s_m, double z_m, double depth_m) const {
    const Eigen::Vector2d at = place_.from + s_m * along_ + depth_m * inwards_;
    return {at.x(), at.y(), z_m};
  }
  double floor_z_m(int storey) const { return place_.floor_z_m + storey * style_.storey_height_m; }

  void add_panel(const Rectangle& r, double depth_m, Surface surface) {
    if (r.s1_m - r.s0_m < 1e-3 || r.z1_m - r.z0_m < 1e-3) return;
    add_quad(mesh_, point(r.s0_m, r.z0_m, depth_m), point(r.s1_m, r.z0_m, depth_m),
             point(r.s1_m, r.z1_m, depth_m), point(r.s0_m, r.z1_m, depth_m), surface);
  }

  /// A block between two depths.
  void add_block(const Rectangle& r, double depth0_m, double depth1_m, Surface surface) {
    add_box(mesh_, frame_, {r.s0_m, depth0_m, r.z0_m}, {r.s1_m, depth1_m, r.z1_m}, surface);
  }

  /// A hole with its four reveals and what closes it at the back.
  void add_opening(const Rectangle& r, double recess_m, Surface back) {
    const std::array<Eigen::Vector2d, 5> corners = {
        {{r.s0_m, r.z0_m}, {r.s1_m, r.z0_m}, {r.s1_m, r.z1_m}, {r.s0_m, r.z1_m}, {r.s0_m, r.z0_m}}};
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d& a = corners[k];
      const Eigen::Vector2d& b = corners[k + 1];
      add_quad(mesh_, point(a.x(), a.y(), 0.0), point(b.x(), b.y(), 0.0),
               point(b.x(), b.y(), recess_m), point(a.x(), a.y(), recess_m), style_.wall);
    }
    add_panel(r, recess_m, back);
  }

  /// A strip below the openings, one above, piers between them.
  void add_storey(int storey, int door_bay, Random& random) {
    const bool shop = storey == 0 && style_.shop;
    const double opening_m = shop ? style_.bay_width_m - 0.5 : style_.window_width_m;
    const double floor_m = floor_z_m(storey);
    const double z0_m = floor_m + (shop ? 0.45 : 0.9);
    const double z1_m = floor_m + (shop ? 2.6 : 0.9 + style_.window_height_m);
    add_panel({0.0, length_m_, z1_m, floor_m + style_.storey_height_m}, 0.0, style_.wall);
    double pier_from_m = 0.0;
    for (int bay = 0; bay < bays_; ++bay) {
      const bool door = bay == door_bay;
      const double width_m = door ? 1.1 : std::min(opening_m, bay_m_ - 0.3);
      const double middle_m = (bay + 0.5) * bay_m_;
      const double left_m = middle_m - 0.5 * bay_m_;
      const double right_m = middle_m + 0.5 * bay_m_;
      const Rectangle hole{middle_m - 0.5 * width_m, middle_m + 0.5 * width_m,
                           door ? floor_m : z0_m, z1_m};
      add_panel({pier_from_m, hole.s0_m, z0_m, z1_m}, 0.0, style_.wall);
      add_opening(hole, door ? 0.35 : style_.recess_m,
                  {door ? Material::kWood : Material::kGlass, random.shade()});
      pier_from_m = hole.s1_m;
      if (door) {
        add_panel({left_m, hole.s0_m, floor_m, z0_m}, 0.0, style_.wall);
        add_panel({hole.s1_m, right_m, floor_m, z0_m}, 0.0, style_.wall);
      } else {
        add_panel({left_m, right_m, floor_m, z0_m}, 0.0, style_.wall);
      }
    }
    add_panel({pier_from_m, length_m_, z0_m, z1_m}, 0.0, style_.wall);
  }

  /// Balconies on some bays above the ground storey.
  void add_balconies(Random& random) {
    const bool solid = random.chance(0.5);
    for (int storey = 1; storey < style_.storeys; ++storey) {
      for (int bay = 0; bay < bays_; ++bay) {
        if (!random.chance(style_.balcony_share)) continue;
        add_balcony(bay * bay_m_ + 0.2, (bay + 1) * bay_m_ - 0.2, floor_z_m(storey), solid);
      }
    }
  }

  /// A slab with a balustrade: solid, or of bars that let most rays through.
  void add_balcony(double s0_m, double s1_m, double z_m, bool solid) {
    constexpr double kReach_m = 1.1;
    const Surface concrete{Material::kConcrete, 170};
    const Surface metal{Material::kMetal, 90};
    add_block({s0_m, s1_m, z_m - 0.16, z_m}, -kReach_m, 0.0, concrete);
    if (solid) {
      add_block({s0_m, s1_m, z_m, z_m + 0.95}, -kReach_m, -kReach_m + 0.06, concrete);
      add_block({s0_m, s0_m + 0.06, z_m, z_m + 0.95}, -kReach_m, 0.0, concrete);
      add_block({s1_m - 0.06, s1_m, z_m, z_m + 0.95}, -kReach_m, 0.0, concrete);
      return;
    }
    add_block({s0_m, s1_m, z_m + 0.93, z_m + 0.98}, -kReach_m, -kReach_m + 0.05, metal);
    const int bars = std::max(2, static_cast<int>((s1_m - s0_m) / 0.22));
    for (int bar = 0; bar <= bars; ++bar) {
      const double s_m = s0_m + (s1_m - s0_m) * bar / bars;
      add_column(mesh_, point(s_m, z_m, -kReach_m + 0.03), point(s_m, z_m + 0.95, -kReach_m + 0.03),
                 0.015, 0.015, 3, metal);
    }
  }

  /// The parts in front of a wall: steps, an oriel, an awning, a gutter pipe.
  void add_relief(int door_bay, Random& random) {
    if (door_bay >= 0) add_steps((door_bay + 0.5) * bay_m_);
    if (style_.storeys > 1 && random.chance(0.35)) {
      const int bay = random.below(bays_);
      add_oriel(bay * bay_m_ + 0.1, (bay + 1) * bay_m_ - 0.1, random);
    }
    if (style_.shop && random.chance(0.5)) {  // an awning over the sidewalk
      const double z_m = place_.floor_z_m + 2.55;
      add_quad(mesh_, point(0.3, z_m + 0.4, 0.0), point(length_m_ - 0.3, z_m + 0.4, 0.0),
               point(length_m_ - 0.3, z_m, -1.3), point(0.3, z_m, -1.3),
               {Material::kCloth, random.shade()});
    }
    add_column(mesh_, point(0.15, place_.foot_z_m, -0.08),
               point(0.15, floor_z_m(style_.storeys), -0.08), 0.06, 0.06, 5,
               {Material::kMetal, 140});
  }

  /// Two steps up to a door.
  void add_steps(double s_m) {
    const Surface stone{Material::kConcrete, 150};
    const double foot_m = place_.foot_z_m;
    const double floor_m = place_.floor_z_m;
    add_block({s_m - 0.9, s_m + 0.9, foot_m, floor_m}, -0.8, 0.0, stone);
    add_block({s_m - 0.9, s_m + 0.9, foot_m, floor_m - 0.17}, -1.15, -0.8, stone);
  }

  /// A bay that sticks out over the upper storeys, with windows on its front.
  void add_oriel(double s0_m, double s1_m, Random& random) {
    constexpr double kReach_m = 0.75;
    add_block({s0_m, s1_m, floor_z_m(1), floor_z_m(style_.storeys) - 0.3}, -kReach_m, 0.0,
              style_.wall);
    for (int storey = 1; storey < style_.storeys; ++storey) {
      const double z_m = floor_z_m(storey) + 0.8;
      add_panel({s0_m + 0.3, s1_m - 0.3, z_m, z_m + style_.window_height_m}, -kReach_m - 0.01,
                {Material::kGlass, random.shade()});
    }
  }

  TriangleMesh& mesh_;
  const WallPlace& place_;
  const FacadeStyle& style_;
  double length_m_;
  int bays_;
  double bay_m_;
  Eigen::Vector2d along_;
  Eigen::Vector2d inwards_;
  Eigen::Isometry3d frame_;
};

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
    Wall wall(city.fixed, place, style);
    if (lot.open_to_view[side]) {
      wall.add_facade(static_cast<int>(side) == lot.front, random);
    } else {
      wall.add_blank();
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
