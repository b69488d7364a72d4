#include "ground.h"

#include <cmath>
#include <numbers>

#include "random.h"

namespace hqslam::sim {

namespace {

constexpr double kOpenLandReach_m = 260.0;
constexpr double kOpenLandCell_m = 10.0;
/// Streets reach under the blocks, which end in rounded corners.
constexpr double kStreetOverlap_m = 1.5;

/// A rectangle of the sheet as a grid on the terrain, lifted by `lift_m(u, v)`.
template <typename Lift>
void add_patch(TriangleMesh& mesh, const Layout& layout, const Eigen::AlignedBox2d& sheet_m,
               const Eigen::Vector2d& cell_m, Surface surface, Lift lift_m) {
  const int rows = steps(sheet_m.sizes().y(), cell_m.y()) + 1;
  const int columns = steps(sheet_m.sizes().x(), cell_m.x()) + 1;
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<std::size_t>(rows) * columns);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2d fraction(static_cast<double>(column) / (columns - 1),
                                     static_cast<double>(row) / (rows - 1));
      const Eigen::Vector2d at = sheet_m.min() + fraction.cwiseProduct(sheet_m.sizes());
      points.push_back(layout.ground(at, lift_m(at)));
    }
  }
  add_grid(mesh, points, rows, columns, surface);
}

/// The kerb line of a block: a rectangle with rounded corners, counter-clockwise, closed.
std::vector<Eigen::Vector2d> kerb_line(const Eigen::AlignedBox2d& sheet_m) {
  constexpr int kArcSteps = 6;
  const Eigen::AlignedBox2d centres(sheet_m.min().array() + kCornerRadius_m,
                                    sheet_m.max().array() - kCornerRadius_m);
  const std::array<Eigen::Vector2d, 4> corner = {
      centres.max(), Eigen::Vector2d(centres.min().x(), centres.max().y()), centres.min(),
      Eigen::Vector2d(centres.max().x(), centres.min().y())};
  std::vector<Eigen::Vector2d> line;
  for (std::size_t k = 0; k < 4; ++k) {
    for (int step = 0; step <= kArcSteps; ++step) {
      const double angle_rad =
          0.5 * std::numbers::pi * (static_cast<double>(k) + static_cast<double>(step) / kArcSteps);
      line.push_back(corner[k] +
                     kCornerRadius_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
    }
    const Eigen::Vector2d from = line.back();
    const double angle_rad = 0.5 * std::numbers::pi * static_cast<double>(k + 1);
    const Eigen::Vector2d to =
        corner[(k + 1) % 4] +
        kCornerRadius_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
    const int count = steps((to - from).norm(), 2.5);
    for (int step = 1; step < count; ++step) {
      line.push_back(from + (to - from) * (static_cast<double>(step) / count));
    }
  }
  line.push_back(line.front());
  return line;
}

void add_kerb_and_sidewalk(TriangleMesh& mesh, const Layout& layout,
                           const Eigen::AlignedBox2d& sheet_m) {
  const std::vector<Eigen::Vector2d> line = kerb_line(sheet_m);
  const Eigen::Vector2d low = sheet_m.min().array() + kSidewalkWidth_m;
  const Eigen::Vector2d high = sheet_m.max().array() - kSidewalkWidth_m;
  const auto inner = [&](const Eigen::Vector2d& at) {
    return Eigen::Vector2d(at.cwiseMax(low).cwiseMin(high));
  };
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Eigen::Vector3d a = layout.ground(line[k], kKerbHeight_m);
    const Eigen::Vector3d b = layout.ground(line[k + 1], kKerbHeight_m);
    add_quad(mesh, layout.ground(line[k], -0.1), layout.ground(line[k + 1], -0.1), b, a,
             {Material::kConcrete, 160});
    add_quad(mesh, a, b, layout.ground(inner(line[k + 1]), kKerbHeight_m + 0.03),
             layout.ground(inner(line[k]), kKerbHeight_m + 0.03), {Material::kConcrete, 90});
  }
}

/// Level with the street, whose strips it covers: tilled ground, or concrete with a seam.
void add_level_ground(TriangleMesh& mesh, const Layout& layout, const Block& block) {
  Random random(seed_of(block.seed, 7));
  if (block.kind == BlockKind::kField) {
    const double roughness_m = random.uniform(0.03, 0.09);
    add_patch(mesh, layout, block.sheet_m, Eigen::Vector2d::Constant(3.0),
              {Material::kGrass, random.shade()}, [&](const Eigen::Vector2d&) {
                return 0.03 + roughness_m * random.uniform(0.0, 1.6);
              });
    return;
  }
  const Material material =
      block.kind == BlockKind::kParkingRows ? Material::kAsphalt : Material::kConcrete;
  add_patch(mesh, layout, block.sheet_m, Eigen::Vector2d::Constant(3.0), {material, 110},
            [](const Eigen::Vector2d&) { return 0.02; });
}

}  // namespace

void add_streets(TriangleMesh& mesh, const Layout& layout) {
  for (int axis = 0; axis < 2; ++axis) {
    for (const Street& street : layout.streets[axis]) {
      Eigen::AlignedBox2d strip = layout.rim_m;
      const double reach_m = street.half_width_m + kStreetOverlap_m;
      strip.min()[axis] = street.position_m - reach_m;
      strip.max()[axis] = street.position_m + reach_m;
      Eigen::Vector2d cell_m(2.5, 2.5);
      cell_m[axis] = 3.0;
      add_patch(mesh, layout, strip, cell_m, {Material::kAsphalt, 120},
                [](const Eigen::Vector2d&) { return 0.0; });
    }
  }
}

void add_block_ground(TriangleMesh& mesh, const Layout& layout, const Block& block) {
  if (!has_sidewalk(block.kind)) return add_level_ground(mesh, layout, block);
  add_kerb_and_sidewalk(mesh, layout, block.sheet_m);
  const Eigen::AlignedBox2d inside(block.sheet_m.min().array() + kSidewalkWidth_m,
                                   block.sheet_m.max().array() - kSidewalkWidth_m);
  const bool paved = block.kind == BlockKind::kSquare || block.kind == BlockKind::kRowHouses;
  // Lawns are not mirrors: their grid points rise and fall by some centimetres.
  const double roughness_m = paved ? 0.0 : 0.05;
  Random random(seed_of(block.seed, 7));
  add_patch(mesh, layout, inside, Eigen::Vector2d::Constant(paved ? 3.0 : 2.0),
            paved ? Surface{Material::kConcrete, 110} : Surface{Material::kGrass, 120},
            [&](const Eigen::Vector2d&) {
              return kKerbHeight_m + 0.03 + roughness_m * random.uniform(-1.0, 0.6);
            });
}

void add_open_land(TriangleMesh& mesh, const Layout& layout) {
  const Eigen::Vector2d low = layout.rim_m.min();
  const Eigen::Vector2d high = layout.rim_m.max();
  const Eigen::Vector2d reach = Eigen::Vector2d::Constant(kOpenLandReach_m);
  const std::array<Eigen::AlignedBox2d, 4> sides = {
      Eigen::AlignedBox2d(low - reach, Eigen::Vector2d(high.x() + reach.x(), low.y())),
      Eigen::AlignedBox2d(Eigen::Vector2d(low.x() - reach.x(), high.y()), high + reach),
      Eigen::AlignedBox2d(Eigen::Vector2d(low.x() - reach.x(), low.y()),
                          Eigen::Vector2d(low.x(), high.y())),
      Eigen::AlignedBox2d(Eigen::Vector2d(high.x(), low.y()),
                          Eigen::Vector2d(high.x() + reach.x(), high.y()))};
  for (const Eigen::AlignedBox2d& side : sides) {
    add_patch(mesh, layout, side, Eigen::Vector2d::Constant(kOpenLandCell_m),
              {Material::kGrass, 90}, [](const Eigen::Vector2d&) { return 0.0; });
  }
}

}  // namespace hqslam::sim
