#include "hqslam/slam/occupancy_grid.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "check_option.h"
#include "dense_map/grid_walk.h"
#include "dense_map/mapped_scan.h"
#include "dense_map/see_through.h"
#include "front_end/mounting.h"
#include "hqslam/core/error.h"
#include "hqslam/slam/dense_map.h"
#include "occupancy_grid/cell_chunks.h"
#include "occupancy_grid/ground_heights.h"

namespace hqslam::slam {

namespace {

constexpr double kMostCells = 4e8;
/// The last cells of a beam are not crossed: they belong to the surface that it met.
constexpr double kEnd_cells = 1.5;

struct Cell {
  std::uint32_t last_scan = 0;    ///< the last that voted, counted from 1
  std::uint16_t times_empty = 0;  ///< scans whose beams crossed it or met its ground; saturates
  std::uint8_t is_free = 0;
  std::uint8_t top = 0;  ///< height of the highest obstacle point above the ground, in kTop_m
};
constexpr double kTop_m = 0.1;

/// One vote against a cell, unless this scan has voted.
void vote_empty(Cell& cell, std::uint32_t scan) {
  if (std::atomic_ref(cell.last_scan).exchange(scan, std::memory_order_relaxed) == scan) return;
  count_up(cell.times_empty);
}

DenseMapOptions obstacle_options(const OccupancyGridOptions& options) {
  DenseMapOptions obstacles;
  obstacles.voxel_m = options.resolution_m;
  obstacles.max_range_m = options.max_range_m;
  obstacles.max_voxels = options.max_voxels;
  return obstacles;
}

/// The points of a scan in the map's frame; NaN where no near one is within max_range_m.
std::vector<Eigen::Vector3d> near_points_m(const MappedScan& scan, double max_range_m) {
  std::vector<Eigen::Vector3d> points_m = scan.points_in_map_m(max_range_m);
  for (Eigen::Vector3d& point_m : points_m) {
    if (!GroundHeights::is_near(point_m)) point_m.setConstant(std::nan(""));
  }
  return points_m;
}

}  // namespace

void validate(const OccupancyGridOptions& options) {
  check_option("occupancy grid", "resolution_m", options.resolution_m, 0.02, 1.0);
  check_option("occupancy grid", "lowest_obstacle_m", options.lowest_obstacle_m, 0.05, 10.0);
  check_option("occupancy grid", "highest_obstacle_m", options.highest_obstacle_m,
               options.lowest_obstacle_m, 20.0);
  check_option("occupancy grid", "max_range_m", options.max_range_m, 1.0, 1000.0);
  check_option("occupancy grid", "max_voxels", static_cast<double>(options.max_voxels), 1.0, 2e9);
}

struct OccupancyGrid::Implementation {
  OccupancyGridOptions options;
  GroundHeights ground;
  DenseMap obstacles;
  CellChunks<Cell> cells;   ///< above known ground; complete once that is settled
  std::uint32_t scans = 0;  ///< calls of see_through so far
  bool settled = false;

  explicit Implementation(const OccupancyGridOptions& options_)
      : options(validated(options_)), obstacles(obstacle_options(options)) {}

  Eigen::Vector2i cell_of(const Eigen::Vector2d& place_m) const {
    return (place_m / options.resolution_m).array().floor().cast<int>();
  }
  void settle();
  void mark_ends(const std::vector<Eigen::Vector3d>& points_m);
  void mark_passed(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& end_m, double near_m);
  CellChunks<std::uint32_t> times_seen() const;
};

/// Ends the collection of the ground and makes all cells, so that threads need not add any.
void OccupancyGrid::Implementation::settle() {
  if (settled) return;
  settled = true;
  ground.settle();
  ground.for_each_known([&](const Eigen::AlignedBox2d& place_m) {
    for (const auto corner : {Eigen::AlignedBox2d::BottomLeft, Eigen::AlignedBox2d::BottomRight,
                              Eigen::AlignedBox2d::TopLeft, Eigen::AlignedBox2d::TopRight}) {
      cells.find_or_add(cell_of(place_m.corner(corner)));
    }
  });
}

/// A scan with an obstacle in a cell does not vote against it.
void OccupancyGrid::Implementation::mark_ends(const std::vector<Eigen::Vector3d>& points_m) {
  std::vector<Cell*> grounds;
  for (const Eigen::Vector3d& point_m : points_m) {
    const auto ground_m = ground.at(point_m.head<2>());
    Cell* const cell = ground_m ? cells.find(cell_of(point_m.head<2>())) : nullptr;
    if (cell == nullptr) continue;
    const double height_m = point_m.z() - *ground_m;
    if (std::abs(height_m) < options.lowest_obstacle_m) grounds.push_back(cell);
    if (height_m >= options.lowest_obstacle_m && height_m <= options.highest_obstacle_m) {
      cell->last_scan = scans;
    }
  }
  for (Cell* const cell : grounds) {
    cell->is_free = 1;
    vote_empty(*cell, scans);
  }
}

/// May be called from many threads at once.
void OccupancyGrid::Implementation::mark_passed(const Eigen::Vector3d& origin_m,
                                                const Eigen::Vector3d& end_m, double near_m) {
  const double length_m = (end_m - origin_m).head<2>().norm();  // horizontal, as all lengths here
  const double passed_m = length_m - kEnd_cells * options.resolution_m;
  if (!(passed_m > 0.0 && GroundHeights::is_near(origin_m))) return;
  const double rise = (end_m.z() - origin_m.z()) / length_m;
  BeamSection beam{{origin_m.x(), origin_m.y(), 0.0}, (end_m - origin_m) / length_m, 0.0, passed_m};
  beam.direction.z() = 0.0;
  const double voting_m = std::min(near_m, seen_through_m(length_m, options.resolution_m));
  const auto pass = [&](const Eigen::Vector3i& index, double at_m, double ground_m) {
    const double height_m = origin_m.z() + rise * at_m - ground_m;
    Cell* const cell = height_m <= kPassed_m ? cells.find({index.x(), index.y()}) : nullptr;
    if (cell == nullptr) return;
    std::atomic_ref(cell->is_free).store(1, std::memory_order_relaxed);
    if (height_m >= options.lowest_obstacle_m && height_m < kTop_m * cell->top &&
        at_m <= voting_m) {
      vote_empty(*cell, scans);
    }
  };
  walk_grid(beam, GroundHeights::kCell_m, [&](const auto&, double begin_m, double end_here_m) {
    const double middle_m = 0.5 * (begin_m + end_here_m);
    const auto ground_m = ground.at((beam.origin_m + middle_m * beam.direction).head<2>());
    const double lowest_m = origin_m.z() + rise * (rise < 0.0 ? end_here_m : begin_m);
    if (!ground_m || lowest_m > *ground_m + kPassed_m) return;
    const BeamSection inside{beam.origin_m, beam.direction, begin_m, end_here_m};
    walk_grid(inside, options.resolution_m, [&](const auto& index, double from_m, double to_m) {
      pass(index, 0.5 * (from_m + to_m), *ground_m);
    });
  });
}

/// Per cell the sum over its voxels of the scans with a point in each.
CellChunks<std::uint32_t> OccupancyGrid::Implementation::times_seen() const {
  CellChunks<std::uint32_t> times_seen;
  for (const DenseMapPoint& point : obstacles.points()) {
    times_seen.find_or_add(cell_of(point.point_m.head<2>().cast<double>())) += point.times_seen;
  }
  return times_seen;
}

OccupancyGrid::OccupancyGrid(const OccupancyGridOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}
OccupancyGrid::~OccupancyGrid() = default;
OccupancyGrid::OccupancyGrid(OccupancyGrid&&) noexcept = default;
OccupancyGrid& OccupancyGrid::operator=(OccupancyGrid&&) noexcept = default;

void OccupancyGrid::add_ground(const OrganizedCloud& measured, const SensorModel& sensor,
                               const SensorPath& path) {
  const MappedScan scan(measured, path);
  if (measured.rows != sensor.rows() || measured.columns != sensor.columns) {
    throw Error("occupancy grid: expected a scan of the sensor's {}x{} pixels, found {}x{}",
                sensor.rows(), sensor.columns, measured.rows, measured.columns);
  }
  Implementation& self = *implementation_;
  const std::vector<Eigen::Vector3d> points_m = near_points_m(scan, self.options.max_range_m);
  OrganizedCloud near = measured;
  for (std::size_t pixel = 0; pixel < points_m.size(); ++pixel) {
    if (!points_m[pixel].allFinite()) near.range_m[pixel] = 0.0F;
  }
  const std::vector<std::uint8_t> is_ground =
      mark_ground_of(near, sensor, path.at(0.0).linear().row(2));
  for (std::size_t pixel = 0; pixel < points_m.size(); ++pixel) {
    if (is_ground[pixel] != 0) self.ground.add(points_m[pixel]);
  }
}

void OccupancyGrid::insert(const OrganizedCloud& cloud,
                           const std::optional<RowSelection>& measured_rows,
                           const SensorPath& path) {
  const MappedScan scan(cloud, path);
  Implementation& self = *implementation_;
  self.settle();
  const std::vector<Eigen::Vector3d> points_m = near_points_m(scan, self.options.max_range_m);
  OrganizedCloud obstacles = cloud;
  obstacles.intensity.clear();  // the map would keep them
  for (std::size_t pixel = 0; pixel < points_m.size(); ++pixel) {
    const auto ground_m = self.ground.at(points_m[pixel].head<2>());
    const double height_m = ground_m ? points_m[pixel].z() - *ground_m : 0.0;
    if (height_m < self.options.lowest_obstacle_m || height_m > self.options.highest_obstacle_m) {
      obstacles.range_m[pixel] = 0.0F;
    } else if (Cell* const cell = self.cells.find(self.cell_of(points_m[pixel].head<2>()))) {
      const double top = std::min(height_m / kTop_m, 255.0);
      cell->top = std::max(cell->top, static_cast<std::uint8_t>(top));
    }
  }
  self.obstacles.insert(obstacles, measured_rows, path);
}

void OccupancyGrid::see_through(const OrganizedCloud& measured, const SensorPath& path) {
  const MappedScan scan(measured, path);
  Implementation& self = *implementation_;
  self.settle();
  self.obstacles.see_through(measured, path);
  ++self.scans;
  const std::vector<Eigen::Vector3d> points_m = near_points_m(scan, self.options.max_range_m);
  self.mark_ends(points_m);
  // Farther away a post fits between two beams.
  const double near_m = self.options.resolution_m * measured.columns / (2.0 * std::numbers::pi);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t pixel = 0; pixel < points_m.size(); ++pixel) {
    if (!points_m[pixel].allFinite()) continue;
    self.mark_passed(scan.T_map_sensor(pixel).translation(), points_m[pixel], near_m);
  }
}

OccupancyMap OccupancyGrid::map() const {
  const Implementation& self = *implementation_;
  const CellChunks<std::uint32_t> times_seen = self.times_seen();
  const auto state_of = [&](const Eigen::Vector2i& at, const Cell& cell) {
    const std::uint32_t* const seen = times_seen.find(at);
    if (seen != nullptr && *seen > 0 && *seen >= cell.times_empty) return Occupancy::kOccupied;
    return cell.is_free != 0 ? Occupancy::kFree : Occupancy::kUnknown;
  };
  Eigen::AlignedBox2i known;
  self.cells.for_each([&](const Eigen::Vector2i& at, const Cell& cell) {
    if (state_of(at, cell) != Occupancy::kUnknown) known.extend(at);
  });
  if (known.isEmpty()) {
    throw Error(
        "occupancy grid: expected ground below the sensor, found none; give poses in a frame whose "
        "z axis points up");
  }
  OccupancyMap map;
  map.resolution_m = self.options.resolution_m;
  map.origin_m = map.resolution_m * known.min().cast<double>();
  const Eigen::Vector2d size = (known.sizes().cast<double>().array() + 1.0);
  if (size.prod() > kMostCells) {
    throw Error(
        "occupancy grid: expected at most {} cells, found {} x {} of {} m; give larger ones",
        kMostCells, size.x(), size.y(), map.resolution_m);
  }
  map.columns = static_cast<int>(size.x());
  map.rows = static_cast<int>(size.y());
  map.cells.resize(static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows));
  self.cells.for_each([&](const Eigen::Vector2i& at, const Cell& cell) {
    if (!known.contains(at)) return;
    const Eigen::Vector2i place(at.x() - known.min().x(), known.max().y() - at.y());
    map.cells[static_cast<std::size_t>(place.y()) * map.columns + place.x()] = state_of(at, cell);
  });
  return map;
}

bool OccupancyGrid::is_full() const { return implementation_->obstacles.is_full(); }

Occupancy OccupancyMap::at(const Eigen::Vector2d& place_m) const {
  const Eigen::Array2d cell = ((place_m - origin_m) / resolution_m).array().floor();
  if (!(cell.x() >= 0.0 && cell.y() >= 0.0 && cell.x() < columns && cell.y() < rows)) {
    return Occupancy::kUnknown;
  }
  const auto row = static_cast<std::size_t>(rows - 1 - static_cast<int>(cell.y()));
  return cells[row * columns + static_cast<std::size_t>(cell.x())];
}

}  // namespace hqslam::slam
