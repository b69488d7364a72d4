#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/slam/sensor_path.h"

namespace hqslam::slam {

struct OccupancyGridOptions {
  double resolution_m = 0.1;  ///< side of a cell; 0.02 to 1
  /// Heights above the ground of what is neither driven over nor under.
  double lowest_obstacle_m = 0.25;
  double highest_obstacle_m = 2.0;
  /// Points farther from the sensor are left out: the ground is hardly known there.
  double max_range_m = 30.0;
  /// Of obstacles. Bounds the memory: one takes about 60 bytes.
  std::size_t max_voxels = 6'000'000;
};
/// Throws Error with field, value and constraint.
void validate(const OccupancyGridOptions& options);

enum class Occupancy : std::uint8_t { kUnknown, kFree, kOccupied };

/// An occupancy grid.
struct OccupancyMap {
  double resolution_m = 0.0;
  /// Map frame: lower left corner.
  Eigen::Matrix<double, 2, 1, Eigen::DontAlign> origin_m = Eigen::Vector2d::Zero();
  int rows = 0;  ///< row 0 has the largest y
  int columns = 0;
  std::vector<Occupancy> cells;  ///< row-major

  /// The state of the cell of a place in the map frame; unknown outside.
  Occupancy at(const Eigen::Vector2d& place_m) const;
};

/// An occupancy grid of the space in which a robot can drive, for Nav2 and the like.
///
/// In: per scan an OrganizedCloud and the path of the sensor, in a frame whose z axis points up.
/// All scans are added three times: for the ground, for the obstacles on it, and for the beams.
/// Out: a cell is
/// - occupied, if a voxel in the band above the ground has a surface with a probability of a half
/// and
///   more (DenseMap, whose voxels have the side of a cell), and the votes for it (the scans with a
///   point in each of its voxels) are at least as many as the votes against it: scans that have no
///   obstacle in the cell, but ground, or a beam through the band, lower than kPassed_m and than
///   the highest point there. Objects that moved are removed by this;
/// - free, if ground was measured in it, or a measured beam passed lower than kPassed_m above it;
/// - unknown otherwise, also without ground within 3 m.
///
/// The ground: pixels of mark_ground, by their mean height in each cell of 0.5 m. Since the flat
/// roof of a car is among them, the ground is the lower envelope
///   ground(c) = min over cells d within 3 m of mean(d) + 0.25 |c - d|,
/// which rises by at most 14 degrees.
/// Source of the idea: occupancy grids, Moravec and Elfes 1985.
///
/// The same scans give the same bytes in any order and for any number of threads, as with DenseMap.
/// Memory grows with the observed area: 8 bytes a cell (50 MB a kilometre in the open) and the
/// voxels.
class OccupancyGrid {
 public:
  /// Height above the ground below which a beam marks a cell as free.
  static constexpr double kPassed_m = 1.0;

  /// Throws Error if an option is invalid.
  explicit OccupancyGrid(const OccupancyGridOptions& options);
  ~OccupancyGrid();
  OccupancyGrid(OccupancyGrid&&) noexcept;  ///< moved from: only assign or destroy
  OccupancyGrid& operator=(OccupancyGrid&&) noexcept;

  /// Adds the ground of a scan of `sensor`. All pixels must be measured. Throws Error if the cloud
  /// does not have its rows and columns.
  void add_ground(const OrganizedCloud& measured, const SensorModel& sensor,
                  const SensorPath& path);
  /// Adds the obstacles of a scan, after the ground of all scans; as DenseMap::insert.
  void insert(const OrganizedCloud& cloud, const std::optional<RowSelection>& measured_rows,
              const SensorPath& path);
  /// Adds the beams of a scan, after the obstacles of all scans; as DenseMap::see_through.
  void see_through(const OrganizedCloud& measured, const SensorPath& path);

  /// The rectangle about all known cells. Throws Error if there are none, or more than 400 million
  /// cells in it.
  OccupancyMap map() const;
  /// Whether obstacles were left out because max_voxels was reached.
  bool is_full() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Writes the image of a map for Nav2's map_server (PGM, binary): 254 free, 0 occupied, 205
/// unknown. Throws Error.
void write_occupancy_image(const OccupancyMap& map, const std::string& path);
/// Writes its .yaml file; image: path of the image relative to this file. Throws Error.
void write_occupancy_yaml(const OccupancyMap& map, const std::string& image,
                          const std::string& path);
/// The map of a .yaml file and its image, of mode trinary. Throws Error.
OccupancyMap read_occupancy_map(const std::string& yaml_path);

}  // namespace hqslam::slam
