#include "evaluate_map/occupancy_grid_error.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "hqslam/recordings/recording.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::tools {

namespace {

constexpr float kReach_m = 20.0F;
constexpr float kAbove_m = 4.0F;  ///< the sensor, and below it: where cells may be
constexpr float kBelow_m = 6.0F;
constexpr double kGround_m = 0.1;
constexpr double kAstray_m = 0.3;         ///< from any true surface: points of moving things
constexpr double kRadius_cells = 0.5642;  ///< of the circle as large as a cell
constexpr double kNear_cells = 1.5;
constexpr int kFreeEvery = 8;      ///< of a grid's free cells: they are many
constexpr std::size_t kEvery = 4;  ///< scan is used: neighbouring scans see the same

sim::UprightColumn column_of(double radius_m) {
  const slam::OccupancyGridOptions options;
  return {radius_m, options.lowest_obstacle_m, options.highest_obstacle_m};
}

/// Points, at most one in each cube of the side of a cell, about the sensor.
class ThinnedPoints {
 public:
  explicit ThinnedPoints(double cell_m) : cell_m_(static_cast<float>(cell_m)) {}

  void add(const Eigen::Vector3f& point_m, const Eigen::Vector3d& sensor_m) {
    const Eigen::Vector3f from_sensor_m = point_m - sensor_m.cast<float>();
    if (!(from_sensor_m.head<2>().norm() <= kReach_m && from_sensor_m.z() <= kAbove_m &&
          from_sensor_m.z() >= -kBelow_m)) {
      return;
    }
    if (taken_.insert(voxel_key(point_m, cell_m_)).second) points_m_.push_back(point_m);
  }
  const std::vector<Eigen::Vector3f>& points_m() const { return points_m_; }
  /// Moved to the middle of their cells.
  std::vector<Eigen::Vector3f> centres_m() const {
    std::vector<Eigen::Vector3f> centres_m = points_m_;
    for (Eigen::Vector3f& point_m : centres_m) {
      point_m.head<2>() = cell_m_ * ((point_m.head<2>() / cell_m_).array().floor() + 0.5F);
    }
    return centres_m;
  }
  /// Key of the cell that contains a point, whatever its height.
  std::uint64_t flat_key_of(const Eigen::Vector3f& point_m) const {
    return voxel_key({point_m.x(), point_m.y(), 0.0F}, cell_m_);
  }

 private:
  float cell_m_;
  std::vector<Eigen::Vector3f> points_m_;
  std::unordered_set<std::uint64_t> taken_;
};

/// A point and the truth at its cell.
struct PlacedPoint {
  Eigen::Vector3f point_m;
  sim::TruePlace cell;

  double height_m() const { return point_m.z() - cell.ground_m; }
  bool is_in_band() const {
    const sim::UprightColumn column = column_of(0.0);
    return height_m() >= column.lowest_m && height_m() <= column.highest_m;
  }
};

std::vector<PlacedPoint> placed(const ThinnedPoints& points, sim::DriveSimulator& city,
                                double cell_m) {
  // Points above each other share a cell.
  std::vector<Eigen::Vector3f> cells_m;
  std::unordered_map<std::uint64_t, std::size_t> cell_of_key;
  for (const Eigen::Vector3f& centre_m : points.centres_m()) {
    if (cell_of_key.try_emplace(points.flat_key_of(centre_m), cells_m.size()).second) {
      cells_m.push_back(centre_m);
    }
  }
  const auto cells = city.true_places(cells_m, column_of(kRadius_cells * cell_m));
  std::vector<PlacedPoint> placed;
  for (const Eigen::Vector3f& point_m : points.points_m()) {
    const auto& cell = cells[cell_of_key.at(points.flat_key_of(point_m))];
    if (cell) placed.push_back({point_m, *cell});
  }
  return placed;
}

/// The middles of the cells of the points that `is_wanted` picks, each once.
template <typename IsWanted>
std::vector<Eigen::Vector3f> cells_of(const std::vector<PlacedPoint>& points, double cell_m,
                                      const IsWanted& is_wanted) {
  ThinnedPoints cells(cell_m);
  for (const PlacedPoint& point : points) {
    if (!is_wanted(point)) continue;
    const Eigen::Vector3f flat_m(point.point_m.x(), point.point_m.y(), 0.0F);
    cells.add(flat_m, flat_m.cast<double>());
  }
  return cells.centres_m();
}

ThinnedPoints visible_points(const TrueDrive& drive, double cell_m) {
  ThinnedPoints points(cell_m);
  sim::DriveSimulator simulator(drive.spec, drive.sensor);
  for (std::size_t scan = 0; scan < drive.truth.size(); scan += kEvery) {
    const auto visible_m = simulator.next_visible();
    if (!visible_m) break;
    for (const Eigen::Vector3f& point_m : *visible_m) {
      points.add(point_m, drive.truth[scan].T_map_sensor.translation());
    }
    simulator.skip(kEvery - 1);
  }
  return points;
}

ThinnedPoints scanned_points(const TrueDrive& drive, double cell_m) {
  ThinnedPoints points(cell_m);
  auto source = recordings::Recording::open(drive.folder);
  for (std::size_t scan = 0; scan < drive.truth.size(); ++scan) {
    const auto recorded = source.next();
    if (!recorded) break;
    if (scan % kEvery != 0) continue;
    const slam::SensorPath path(drive.truth, scan);
    const OrganizedCloud& cloud = recorded->cloud;
    for (std::size_t pixel = 0; pixel < cloud.range_m.size(); ++pixel) {
      if (!(cloud.range_m[pixel] > 0.0F) || cloud.range_m[pixel] > kReach_m) continue;
      const Pose T_map_sensor =
          path.at(cloud.time_offset_s.empty() ? 0.0 : cloud.time_offset_s[pixel]);
      points.add((T_map_sensor * cloud.points_m[pixel].cast<double>()).cast<float>(),
                 T_map_sensor.translation());
    }
  }
  return points;
}

}  // namespace

TrueCells true_cells(const TrueDrive& drive, double cell_m) {
  sim::DriveSimulator city(drive.spec, drive.sensor);
  TrueCells cells;
  const std::vector<PlacedPoint> visible = placed(visible_points(drive, cell_m), city, cell_m);
  cells.empty_m = cells_of(visible, cell_m, [](const PlacedPoint& point) {
    return !point.cell.is_occupied && std::abs(point.height_m()) <= kGround_m;
  });
  cells.standing_m = cells_of(visible, cell_m, [](const PlacedPoint& point) {
    return point.cell.is_occupied && point.is_in_band();
  });
  std::vector<PlacedPoint> astray = placed(scanned_points(drive, cell_m), city, cell_m);
  std::erase_if(astray, [](const PlacedPoint& point) {
    return point.cell.is_occupied || !point.is_in_band();
  });
  std::vector<Eigen::Vector3f> astray_m;
  for (const PlacedPoint& point : astray) astray_m.push_back(point.point_m);
  const std::vector<float> distances_m = city.distances_to_surface_m(astray_m, kAstray_m);
  cells.moving_m = cells_of(astray, cell_m, [&](const PlacedPoint& point) {
    return !std::isfinite(distances_m[static_cast<std::size_t>(&point - astray.data())]);
  });
  return cells;
}

OccupancyGridError occupancy_grid_error(const slam::OccupancyMap& map, const Pose& T_truth_map,
                                        const TrueCells& cells, const TrueDrive& drive) {
  using slam::Occupancy;
  const Pose T_map_truth = T_truth_map.inverse();
  const auto at = [&](const Eigen::Vector3f& centre_m, int dx = 0, int dy = 0) {
    const Eigen::Vector2d place_m = (T_map_truth * centre_m.cast<double>()).head<2>();
    return map.at(place_m + map.resolution_m * Eigen::Vector2d(dx, dy));
  };
  const auto share_called = [&](const auto& centres_m, Occupancy occupancy) {
    return share_of(centres_m, [&](const auto& centre_m) { return at(centre_m) == occupancy; });
  };
  OccupancyGridError error;
  error.empty_is_free = share_called(cells.empty_m, Occupancy::kFree);
  error.empty_is_occupied = share_called(cells.empty_m, Occupancy::kOccupied);
  error.standing_is_occupied = share_called(cells.standing_m, Occupancy::kOccupied);
  error.standing_is_free = share_called(cells.standing_m, Occupancy::kFree);
  error.moving_is_occupied = share_called(cells.moving_m, Occupancy::kOccupied);
  const auto is_near = [&](const Eigen::Vector3f& centre_m) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (at(centre_m, dx, dy) == Occupancy::kOccupied) return true;
      }
    }
    return false;
  };
  error.standing_is_near = share_of(cells.standing_m, is_near);

  sim::DriveSimulator city(drive.spec, drive.sensor);
  const auto wrong_share = [&](Occupancy occupancy, double radius_cells, bool right) {
    ThinnedPoints centres(map.resolution_m);
    for (int row = 0; row < map.rows; ++row) {
      for (int column = 0; column < map.columns; ++column) {
        const auto cell = static_cast<std::size_t>(row) * map.columns + column;
        if (map.cells[cell] != occupancy) continue;
        if (occupancy == Occupancy::kFree && (row + column) % kFreeEvery != 0) continue;
        const Eigen::Vector2d place_m =
            map.origin_m + map.resolution_m * Eigen::Vector2d(column + 0.5, map.rows - row - 0.5);
        const Eigen::Vector3d true_m = T_truth_map * Eigen::Vector3d(place_m.x(), place_m.y(), 0.0);
        const auto nearest =
            std::ranges::min_element(drive.truth, {}, [&](const StampedPose& pose) {
              return (pose.T_map_sensor.translation() - true_m).head<2>().squaredNorm();
            });
        if (nearest == drive.truth.end()) continue;
        const Eigen::Vector3d sensor_m = nearest->T_map_sensor.translation();
        centres.add(Eigen::Vector3d(true_m.x(), true_m.y(), sensor_m.z()).cast<float>(), sensor_m);
      }
    }
    const auto places =
        city.true_places(centres.points_m(), column_of(radius_cells * map.resolution_m));
    const auto is_wrong = [&](const auto& place) { return place && place->is_occupied != right; };
    return share_of(places, is_wrong);
  };
  error.free_is_wrong = wrong_share(Occupancy::kFree, kRadius_cells, false);
  error.occupied_is_wrong = wrong_share(Occupancy::kOccupied, kNear_cells, true);
  return error;
}

}  // namespace hqslam::tools
