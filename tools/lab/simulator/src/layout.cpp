#include "layout.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "hqslam/core/pose.h"
#include "random.h"

namespace hqslam::sim {

namespace {

constexpr double kOuterBlockDepth_m = 48.0;

Street make_street(const CityStyle& style, double position_m, Random& random) {
  const double width = random.uniform();
  const bool tree_lined = random.chance(0.7);
  if (style.plain_streets) {
    const auto& [half_width_m, lane_offset_m] = *style.plain_streets;
    return {position_m, half_width_m, lane_offset_m, false, false};
  }
  Street street{.position_m = position_m, .tree_lined = tree_lined};
  if (width < 0.2) {
    street.half_width_m = 4.2;
    street.parking = false;
  } else if (width > 0.7) {
    street.half_width_m = 8.0;
    street.lane_offset_m = 2.8;
  }
  return street;
}

std::vector<Street> make_streets(const CityStyle& style, const StreetGrid& grid, Random& random) {
  std::vector<Street> streets;
  double position_m = 0.0;
  for (int i = 0; i < grid.streets; ++i) {
    streets.push_back(make_street(style, position_m, random));
    position_m += random.uniform(grid.min_spacing_m, grid.max_spacing_m);
  }
  const double middle_m = 0.5 * (streets.front().position_m + streets.back().position_m);
  for (Street& street : streets) street.position_m -= middle_m;
  return streets;
}

/// Tangents of the bending add up to `bend` at most, so that streets never fold.
std::array<BendingWave, 3> make_bending(double bend, Random& random) {
  std::array<BendingWave, 3> waves;
  constexpr std::array<double, 3> kWavelength_m = {410.0, 270.0, 170.0};
  for (std::size_t k = 0; k < waves.size(); ++k) {
    const double direction_rad =
        std::numbers::pi * (static_cast<double>(k) / 3.0 + 0.25) + random.uniform(-0.3, 0.3);
    const double wave_number =
        2.0 * std::numbers::pi / (kWavelength_m[k] * random.uniform(0.85, 1.15));
    const Eigen::Vector2d along(std::cos(direction_rad), std::sin(direction_rad));
    // Across the wave: shearing bends streets, stretching would only widen them.
    waves[k] = {wave_number * along,
                bend * 0.6 / wave_number * Eigen::Vector2d(-along.y(), along.x()),
                random.uniform(0.0, 2.0 * std::numbers::pi)};
  }
  return waves;
}

/// At most one stretch per street of axis 0, never at the rim: every crossing keeps two ways out.
std::set<Stretch> close_stretches(const CityStyle& style, Random& random) {
  std::set<Stretch> closed;
  int previous = -1;
  for (int street = 1; street + 1 < style.grid[0].streets; ++street) {
    const bool close = random.chance(style.closed_street_share);
    const int crossing = random.below(style.grid[1].streets - 1);
    if (close && crossing != previous) closed.insert({street, crossing});
    previous = close ? crossing : -1;
  }
  return closed;
}

BlockKind pick_kind(const BlockWeights& weights, Random& random) {
  double draw = random.uniform(0.0, std::accumulate(weights.begin(), weights.end(), 0.0));
  for (std::size_t kind = 0; kind < weights.size(); ++kind) {
    draw -= weights[kind];
    if (draw < 0.0) return static_cast<BlockKind>(kind);
  }
  return BlockKind::kRowHouses;
}

/// From kerb to kerb along one axis, and from the outermost kerbs to the rim.
struct Cell {
  double low_m;
  double high_m;
};

std::vector<Cell> cells_between(const std::vector<Street>& streets, double low_end_m,
                                double high_end_m) {
  std::vector<Cell> cells;
  for (const Street& street : streets) {
    cells.push_back({low_end_m, street.position_m - street.half_width_m});
    low_end_m = street.position_m + street.half_width_m;
  }
  cells.push_back({low_end_m, high_end_m});
  return cells;
}

std::vector<Block> make_blocks(const CityStyle& style, const Layout& layout, std::uint64_t seed) {
  const Eigen::AlignedBox2d& rim_m = layout.rim_m;
  const auto u = cells_between(layout.streets[0], rim_m.min().x(), rim_m.max().x());
  const auto v = cells_between(layout.streets[1], rim_m.min().y(), rim_m.max().y());
  std::vector<Block> blocks;
  const int last_u = style.grid[0].streets;
  const int last_v = style.grid[1].streets;
  for (int i = 0; i <= last_u; ++i) {
    for (int j = 0; j <= last_v; ++j) {
      // The cells i and i + 1 of axis 0 are one block beside a closed stretch of street i.
      if (i > 0 && layout.closed.contains({i - 1, j - 1})) continue;
      const bool wide = layout.closed.contains({i, j - 1});
      const Eigen::Vector2d low_m(u[i].low_m, v[j].low_m);
      const Eigen::Vector2d high_m(u[wide ? i + 1 : i].high_m, v[j].high_m);
      const auto block_seed =
          seed_of(seed, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j));
      Random random(block_seed);
      const bool at_rim = i == 0 || i == last_u || j == 0 || j == last_v;
      const BlockKind kind = pick_kind(
          at_rim ? style.rim_block_weights.value_or(style.block_weights) : style.block_weights,
          random);
      blocks.push_back({{low_m, high_m}, kind, block_seed});
    }
  }
  return blocks;
}

}  // namespace

Eigen::Vector2d Layout::plane(const Eigen::Vector2d& sheet_m) const {
  Eigen::Vector2d plane_m = sheet_m;
  for (const BendingWave& wave : bending) {
    plane_m +=
        std::sin(wave.wave_vector_rad_per_m.dot(sheet_m) + wave.phase_rad) * wave.amplitude_m;
  }
  return plane_m;
}

double Layout::heading_rad(const Eigen::Vector2d& sheet_m, const Eigen::Vector2d& direction) const {
  const Eigen::Vector2d step_m =
      plane(sheet_m + 0.5 * direction) - plane(sheet_m - 0.5 * direction);
  return std::atan2(step_m.y(), step_m.x());
}

Layout make_layout(const CityStyle& style, std::uint64_t seed) {
  Random random(seed_of(seed, 1));
  Layout layout{.streets = {},
                .closed = {},
                .blocks = {},
                .rim_m = {},
                .bending = make_bending(style.bend, random),
                .terrain = Terrain(seed_of(seed, 2), style.slope_bound)};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    layout.streets[axis] = make_streets(style, style.grid[axis], random);
  }
  layout.closed = close_stretches(style, random);
  for (int axis = 0; axis < 2; ++axis) {
    layout.rim_m.min()[axis] = layout.streets[axis].front().position_m - kOuterBlockDepth_m;
    layout.rim_m.max()[axis] = layout.streets[axis].back().position_m + kOuterBlockDepth_m;
  }
  layout.blocks = make_blocks(style, layout, seed_of(seed, 3));
  return layout;
}

Terrain::Terrain(std::uint64_t seed, double slope_bound) {
  Random random(seed);
  const double turn = random.uniform(0.0, std::numbers::pi);
  double wavelength_m = 520.0;
  for (std::size_t k = 0; k < waves_.size(); ++k) {
    // Directions spread over the half circle, so that no direction is left flat.
    const double direction_rad =
        turn + std::numbers::pi * (static_cast<double>(k * 5 % 6) + random.uniform(0.0, 0.7)) / 6.0;
    const double wave_number = 2.0 * std::numbers::pi / wavelength_m;
    waves_[k] = {wave_number * Eigen::Vector2d(std::cos(direction_rad), std::sin(direction_rad)),
                 slope_bound / static_cast<double>(waves_.size()) / wave_number,
                 random.uniform(0.0, 2.0 * std::numbers::pi)};
    wavelength_m *= random.uniform(0.72, 0.86);
  }
}

double Terrain::height_m(const Eigen::Vector2d& plane_m) const {
  double height_m = 0.0;
  for (const Wave& wave : waves_) {
    height_m +=
        wave.amplitude_m * std::sin(wave.wave_vector_rad_per_m.dot(plane_m) + wave.phase_rad);
  }
  return height_m;
}

Eigen::Vector2d Terrain::slope(const Eigen::Vector2d& plane_m) const {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (const Wave& wave : waves_) {
    slope += wave.amplitude_m * std::cos(wave.wave_vector_rad_per_m.dot(plane_m) + wave.phase_rad) *
             wave.wave_vector_rad_per_m;
  }
  return slope;
}

Eigen::Vector3d Terrain::ground(const Eigen::Vector2d& plane_m, double lift_m) const {
  return {plane_m.x(), plane_m.y(), height_m(plane_m) + lift_m};
}

Eigen::Isometry3d Terrain::frame(const Eigen::Vector2d& plane_m, double heading_rad) const {
  const Eigen::Vector2d rise = slope(plane_m);
  const Eigen::Vector2d forward(std::cos(heading_rad), std::sin(heading_rad));
  const Eigen::Vector2d left(-forward.y(), forward.x());
  return pose_from_xyz_rpy(ground(plane_m, 0.0), std::atan(rise.dot(left)),
                           -std::atan(rise.dot(forward)), heading_rad);
}

}  // namespace hqslam::sim
