#include "city.h"

#include <numbers>

namespace hqslam::sim {

namespace {

/// One of some shapes, turned and scaled as drawn.
void place_plant(City& city, int first_shape, int shapes, double largest_scale,
                 const Eigen::Vector3d& foot_m, Random& random) {
  const double heading_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double scale = random.uniform(0.8, largest_scale);
  city.placements.push_back(
      {first_shape + random.below(shapes),
       Eigen::Affine3d(upright_frame(foot_m, heading_rad)) * Eigen::Scaling(scale), 128});
}

/// Tree lines and lone trees in the open land, so that the horizon is not empty.
void plant_open_land(City& city, double trees_per_m, std::uint64_t seed) {
  Random random(seed);
  const Eigen::Vector2d low = city.layout.rim_m.min();
  const Eigen::Vector2d size = city.layout.rim_m.sizes();
  const double around_m = 2.0 * size.sum();
  const int trees = static_cast<int>(around_m * trees_per_m);
  for (int tree = 0; tree < trees; ++tree) {
    const BlockSide side = sides_of(city.layout.rim_m)[random.below(4)];
    const bool in_line = random.chance(0.6);
    const double away_m = in_line ? 18.0 + random.uniform(-1.0, 1.0) : random.uniform(8.0, 120.0);
    const Eigen::Vector2d at = side.at(random.uniform(-60.0, side.length_m + 60.0), -away_m);
    const bool inside = ((at - low).array() > 0.0).all() && ((low + size - at).array() > 0.0).all();
    if (!inside) place_tree(city, at, 0.0, random);
  }
}

}  // namespace

std::array<BlockSide, 4> sides_of(const Eigen::AlignedBox2d& sheet_m) {
  const Eigen::Vector2d low = sheet_m.min();
  const Eigen::Vector2d high = sheet_m.max();
  const Eigen::Vector2d size = sheet_m.sizes();
  return {{{low, {1.0, 0.0}, {0.0, 1.0}, size.x()},
           {{high.x(), low.y()}, {0.0, 1.0}, {-1.0, 0.0}, size.y()},
           {high, {-1.0, 0.0}, {0.0, -1.0}, size.x()},
           {{low.x(), high.y()}, {0.0, -1.0}, {1.0, 0.0}, size.y()}}};
}

Eigen::Isometry3d frame_at(const City& city, const Eigen::Vector2d& sheet_m,
                           const Eigen::Vector2d& along, double lift_m) {
  return upright_frame(city.layout.ground(sheet_m, lift_m),
                       city.layout.heading_rad(sheet_m, along));
}

Eigen::Vector2d draw_inside(const Eigen::AlignedBox2d& sheet_m, double margin_m, Random& random) {
  Eigen::Vector2d fraction;
  fraction.y() = random.uniform();
  fraction.x() = random.uniform();
  return (sheet_m.min().array() + margin_m).matrix() +
         fraction.cwiseProduct((sheet_m.sizes().array() - 2.0 * margin_m).matrix());
}

void scatter(City& city, decltype(&place_tree) place, int count, const Eigen::AlignedBox2d& sheet_m,
             double margin_m, double lift_m, Random& random) {
  for (int k = 0; k < count; ++k) {
    place(city, draw_inside(sheet_m, margin_m, random), lift_m, random);
  }
}

void place_tree(City& city, const Eigen::Vector2d& sheet_m, double lift_m, Random& random) {
  place_plant(city, kFirstTree, kTreeShapes, 1.35, city.layout.ground(sheet_m, lift_m), random);
}

void place_bush(City& city, const Eigen::Vector2d& sheet_m, double lift_m, Random& random) {
  place_plant(city, kFirstBush, kBushShapes, 1.6, city.layout.ground(sheet_m, lift_m), random);
}

void park_car(City& city, const Eigen::Vector2d& sheet_m, double heading_rad, Random& random) {
  const int body = kFirstCar + random.below(kCarBodies);
  const Eigen::Vector2d plane_m = city.layout.plane(sheet_m);
  city.placements.push_back(
      {body, Eigen::Affine3d(city.layout.terrain.frame(plane_m, heading_rad)), random.shade()});
}

City make_city(const CityStyle& style, std::uint64_t seed) {
  City city{{.fixed = {}, .prototypes = make_prototypes(seed_of(seed, 11)), .placements = {}},
            make_layout(style, seed),
            style.parked_car_share};
  add_open_land(city);
  add_streets(city);
  for (const Block& block : city.layout.blocks) {
    add_block_ground(city, block);
    fill_block(city, block);
    if (has_sidewalk(block.kind)) furnish_sidewalks(city, block);
  }
  plant_open_land(city, style.rim_trees_per_m, seed_of(seed, 12));
  return city;
}

}  // namespace hqslam::sim
