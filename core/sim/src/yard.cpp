#include <numbers>

#include "furniture.h"
#include "level_blocks.h"

namespace hqslam::sim {

namespace {

Eigen::Isometry3d drawn_frame(const City& city, const Eigen::Vector2d& sheet_m, Random& random) {
  // Most things are put down in line with the yard.
  const double quarter_turns = random.below(4);
  const double askew_rad = random.chance(0.3) ? random.uniform(-0.6, 0.6) : 0.0;
  return upright_frame(city.layout.ground(sheet_m, 0.02),
                       0.5 * std::numbers::pi * quarter_turns + askew_rad);
}

void add_container(City& city, const Eigen::Vector2d& at, Random& random) {
  const Surface steel{Material::kMetal, random.shade()};
  add_box(city.fixed, drawn_frame(city, at, random), {-3.03, -1.22, -0.1}, {3.03, 1.22, 2.6},
          steel);
}

void add_pallets(City& city, const Eigen::Vector2d& at, Random& random) {
  const Eigen::Isometry3d frame = drawn_frame(city, at, random);
  const int pallets = 1 + random.below(9);
  const Surface wood{Material::kWood, random.shade()};
  for (int pallet = 0; pallet < pallets; ++pallet) {
    const double z_m = 0.15 * pallet;
    const double aside_m = random.uniform(-0.03, 0.03);
    // Two thin decks with air between them.
    add_box(city.fixed, frame, {-0.6 + aside_m, -0.4, z_m + 0.12},
            {0.6 + aside_m, 0.4, z_m + 0.145}, wood);
    for (const double y_m : {-0.4, -0.05, 0.3}) {
      add_box(city.fixed, frame, {-0.6 + aside_m, y_m, z_m}, {0.6 + aside_m, y_m + 0.1, z_m + 0.12},
              wood);
    }
  }
  if (random.chance(0.5)) {
    const double height_m = random.uniform(0.3, 1.2);
    add_box(city.fixed, frame, {-0.55, -0.35, 0.15 * pallets},
            {0.55, 0.35, 0.15 * pallets + height_m}, {Material::kCloth, random.shade()});
  }
}

void add_drums(City& city, const Eigen::Vector2d& at, Random& random) {
  const Eigen::Isometry3d frame = drawn_frame(city, at, random);
  const int drums = 1 + random.below(5);
  for (int drum = 0; drum < drums; ++drum) {
    const int row = drum / 3;
    const Eigen::Vector3d foot(0.66 * (drum % 3), 0.66 * row, -0.1);
    add_column(city.fixed, frame * foot, frame * (foot + Eigen::Vector3d(0.0, 0.0, 1.0)), 0.3, 0.3,
               12, {Material::kMetal, random.shade()});
  }
}

void add_bollards(City& city, const Eigen::Vector2d& at, Random& random) {
  const Eigen::Isometry3d frame = drawn_frame(city, at, random);
  const int bollards = 2 + random.below(5);
  for (int bollard = 0; bollard < bollards; ++bollard) {
    const Eigen::Vector3d foot(1.4 * bollard, 0.0, -0.1);
    add_column(city.fixed, frame * foot, frame * (foot + Eigen::Vector3d(0.0, 0.0, 1.0)), 0.06,
               0.06, 8, {Material::kMetal, 190});
  }
}

}  // namespace

void add_yard(City& city, const Block& block, Random& random) {
  // Two containers or cars, whose length decides the margin, then smaller things.
  constexpr double kLongMargin_m = 3.8;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector2d at = draw_inside(block.sheet_m, kLongMargin_m, random);
    if (random.chance(0.6)) {
      add_container(city, at, random);
    } else {
      park_car(city, at, random.uniform(0.0, 6.2), random);
    }
  }
  const int things = static_cast<int>(block.sheet_m.volume() / 28.0);
  for (int thing = 0; thing < things; ++thing) {
    const double kind = random.uniform();
    const Eigen::Vector2d at =
        draw_inside(block.sheet_m, kind < 0.55 ? 1.2 : (kind < 0.7 ? 2.2 : 6.5), random);
    if (kind < 0.3) {
      add_pallets(city, at, random);
    } else if (kind < 0.4) {
      place_bush(city, at, 0.0, random);
    } else if (kind < 0.55) {
      add_bin(city.fixed, drawn_frame(city, at, random), random);
    } else if (kind < 0.7) {
      add_drums(city, at, random);
    } else if (kind < 0.85) {
      add_bollards(city, at, random);
    } else if (kind < 0.92) {
      place_tree(city, at, 0.0, random);
    }
  }
}

}  // namespace hqslam::sim
