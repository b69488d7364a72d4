#include <cmath>
#include <numbers>

#include "city.h"

namespace hqslam::sim {

namespace {

constexpr double kOpenLandReach_m = 260.0;
constexpr double kOpenLandCell_m = 10.0;
/// Streets reach under the blocks, which end in rounded corners.
constexpr double kStreetOverlap_m = 1.5;

/// A rectangle of the sheet as a grid on the terrain, each point lifted by `lift_m()`.
template <typename Lift>
void add_patch(City& city, const Eigen::AlignedBox2d& sheet_m, const Eigen::Vector2d& cell_m,
               Surface surface, Lift lift_m) {
  const int rows = steps(sheet_m.sizes().y(), cell_m.y()) + 1;
  const int columns = steps(sheet_m.sizes().x(), cell_m.x()) + 1;
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<std::size_t>(rows) * columns);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2d fraction(static_cast<double>(column) / (columns - 1),
                                     static_cast<double>(row) / (rows - 1));
      const Eigen::Vector2d at = sheet_m.min() + fraction.cwiseProduct(sheet_m.sizes());
      points.push_back(city.layout.ground(at, lift_m()));
    }
  }
  add_grid(city.fixed, points, rows, columns, surface);
}

void add_even_patch(City& city, const Eigen::AlignedBox2d& sheet_m, const Eigen::Vector2d& cell_m,
                    Surface surface, double lift_m) {
  add_patch(city, sheet_m, cell_m, surface, [lift_m] { return lift_m; });
}

/// The kerb line of a block: a rectangle with rounded corners, counter-clockwise, closed.
std::vector<Eigen::Vector2d> kerb_line(const Eigen::AlignedBox2d& sheet_m) {
  constexpr int kArcSteps = 6;
  const Eigen::Vector2d low = sheet_m.min().array() + kCornerRadius_m;
  const Eigen::Vector2d high = sheet_m.max().array() - kCornerRadius_m;
  const std::array<Eigen::Vector2d, 4> centre = {high, Eigen::Vector2d(low.x(), high.y()), low,
                                                 Eigen::Vector2d(high.x(), low.y())};
  const auto on_arc = [&](std::size_t corner, double quarter_turns) {
    const double angle_rad = 0.5 * std::numbers::pi * quarter_turns;
    return Eigen::Vector2d(centre[corner % 4] +
                           kCornerRadius_m *
                               Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
  };
  std::vector<Eigen::Vector2d> line;
  for (std::size_t k = 0; k < 4; ++k) {
    for (int step = 0; step <= kArcSteps; ++step) {
      line.push_back(on_arc(k, static_cast<double>(k) + static_cast<double>(step) / kArcSteps));
    }
    const Eigen::Vector2d from = line.back();
    const Eigen::Vector2d to = on_arc(k + 1, static_cast<double>(k + 1));
    const int count = steps((to - from).norm(), 2.5);
    for (int step = 1; step < count; ++step) {
      line.push_back(from + (to - from) * (static_cast<double>(step) / count));
    }
  }
  line.push_back(line.front());
  return line;
}

/// The ground inside the sidewalk of a block.
Eigen::AlignedBox2d inside_of(const Block& block) {
  return {block.sheet_m.min().array() + kSidewalkWidth_m,
          block.sheet_m.max().array() - kSidewalkWidth_m};
}

void add_kerb_and_sidewalk(City& city, const Block& block) {
  const std::vector<Eigen::Vector2d> line = kerb_line(block.sheet_m);
  const Eigen::AlignedBox2d inside = inside_of(block);
  const auto at = [&](std::size_t k, double lift_m) { return city.layout.ground(line[k], lift_m); };
  const auto inner = [&](std::size_t k) {
    return city.layout.ground(line[k].cwiseMax(inside.min()).cwiseMin(inside.max()),
                              kKerbHeight_m + 0.03);
  };
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Eigen::Vector3d a = at(k, kKerbHeight_m);
    const Eigen::Vector3d b = at(k + 1, kKerbHeight_m);
    add_quad(city.fixed, at(k, -0.1), at(k + 1, -0.1), b, a, {Material::kConcrete, 160});
    add_quad(city.fixed, a, b, inner(k + 1), inner(k), {Material::kConcrete, 90});
  }
}

/// Level with the street, whose strips it covers: tilled ground, or concrete with a seam.
void add_level_ground(City& city, const Block& block, Random& random) {
  const Eigen::Vector2d cell_m(3.0, 3.0);
  if (block.kind == BlockKind::kField) {
    const double roughness_m = random.uniform(0.03, 0.09);
    add_patch(city, block.sheet_m, cell_m, {Material::kGrass, random.shade()},
              [&] { return 0.03 + roughness_m * random.uniform(0.0, 1.6); });
    return;
  }
  const bool cars = block.kind == BlockKind::kParkingRows;
  add_even_patch(city, block.sheet_m, cell_m,
                 {cars ? Material::kAsphalt : Material::kConcrete, 110}, 0.02);
}

}  // namespace

void add_streets(City& city) {
  for (int axis = 0; axis < 2; ++axis) {
    for (const Street& street : city.layout.streets[axis]) {
      Eigen::AlignedBox2d strip = city.layout.rim_m;
      const double reach_m = street.half_width_m + kStreetOverlap_m;
      strip.min()[axis] = street.position_m - reach_m;
      strip.max()[axis] = street.position_m + reach_m;
      Eigen::Vector2d cell_m(2.5, 2.5);
      cell_m[axis] = 3.0;
      add_even_patch(city, strip, cell_m, {Material::kAsphalt, 120}, 0.0);
    }
  }
}

void add_block_ground(City& city, const Block& block) {
  Random random(seed_of(block.seed, 7));
  if (!has_sidewalk(block.kind)) return add_level_ground(city, block, random);
  add_kerb_and_sidewalk(city, block);
  constexpr double kLift_m = kKerbHeight_m + 0.03;
  if (block.kind == BlockKind::kSquare || block.kind == BlockKind::kRowHouses) {
    add_even_patch(city, inside_of(block), {3.0, 3.0}, {Material::kConcrete, 110}, kLift_m);
    return;
  }
  // Lawns are not mirrors: their grid points rise and fall by some centimetres.
  add_patch(city, inside_of(block), {2.0, 2.0}, {Material::kGrass, 120},
            [&] { return kLift_m + 0.05 * random.uniform(-1.0, 0.6); });
}

void add_open_land(City& city) {
  const Eigen::Vector2d low = city.layout.rim_m.min();
  const Eigen::Vector2d high = city.layout.rim_m.max();
  const Eigen::Vector2d outer_low = low.array() - kOpenLandReach_m;
  const Eigen::Vector2d outer_high = high.array() + kOpenLandReach_m;
  const auto add = [&](double low_u, double low_v, double high_u, double high_v) {
    add_even_patch(city, {Eigen::Vector2d(low_u, low_v), Eigen::Vector2d(high_u, high_v)},
                   Eigen::Vector2d::Constant(kOpenLandCell_m), {Material::kGrass, 90}, 0.0);
  };
  add(outer_low.x(), outer_low.y(), outer_high.x(), low.y());
  add(outer_low.x(), high.y(), outer_high.x(), outer_high.y());
  add(outer_low.x(), low.y(), low.x(), high.y());
  add(high.x(), low.y(), outer_high.x(), high.y());
}

}  // namespace hqslam::sim
