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
  /// Above the ground beneath it: what is lower can be driven over, what is higher driven under.
  double lowest_obstacle_m = 0.25;
  double highest_obstacle_m = 2.0;
  /// Of a point from the sensor, beyond which it says nothing: the ground is hardly known there.
  double max_range_m = 30.0;
  /// Of obstacles; memory is bounded by it: one takes about 50 bytes.
  std::size_t max_voxels = 6'000'000;
};
/// Throws Error with field, value and constraint.
void validate(const OccupancyGridOptions& options);

enum class Occupancy : std::uint8_t { kUnknown, kFree, kOccupied };

/// Where a robot can be, seen from above.
struct OccupancyMap {
  double resolution_m = 0.0;
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  ///< map frame: lower left corner
  int rows = 0;                                        ///< row 0 has the largest y
  int columns = 0;
  std::vector<Occupancy> cells;  ///< row-major

  /// Of the cell that a place of the map frame is in; unknown outside.
  Occupancy at(const Eigen::Vector2d& place_m) const;
};

/// A map of where a robot can drive, from all scans of a drive, for Nav2 and the like.
///
/// In: per scan an OrganizedCloud and the path of the sensor, in a frame whose z axis points up.
/// The scans come three times, each time all of them: first they tell where the ground is, then
/// what stands on it, then what they saw through. Out: a cell is
/// - occupied, if a voxel in the band above the ground beneath it holds a surface with a
///   probability of a half and more (DenseMap, whose voxels have the side of a cell), and its
///   voxels were seen at least as often, scans with a point in each counted, as the cell was seen
///   empty: by scans that saw its ground, or looked through it within the band, lower than
///   kPassed_m and than what was seen there, and have no obstacle in it. Whoever moved is gone;
/// - free, if the ground was seen in it, or a measured beam passed lower than kPassed_m above it;
/// - unknown otherwise, also where no ground was seen within 3 m.
///
/// The ground: pixels that mark_ground takes for it, their mean height in each cell of 0.5 m. The
/// flat roof of a car is taken for ground too, so the ground is the lower envelope
///   ground(c) = min over cells d within 3 m of mean(d) + 0.25 |c - d|:
/// it rises by 14 degrees at most.
/// Source of the idea: occupancy grids, Moravec and Elfes 1985.
///
/// The same scans give the same bytes, whatever their order and the number of threads, as with
/// DenseMap. Memory follows the area that was seen: 8 bytes a cell (50 MB a kilometre with free
/// sight) and the voxels.
class OccupancyGrid {
 public:
  /// A beam that passes so low says that a cell is free.
  static constexpr double kPassed_m = 1.0;

  /// Throws Error if an option is invalid.
  explicit OccupancyGrid(const OccupancyGridOptions& options);
  ~OccupancyGrid();
  OccupancyGrid(OccupancyGrid&&) noexcept;  ///< moved from: only assign or destroy
  OccupancyGrid& operator=(OccupancyGrid&&) noexcept;

  /// What a scan says of the ground. All its pixels must be measured; sensor: its own. Throws Error
  /// if the cloud does not have its rows and columns.
  void add_ground(const OrganizedCloud& measured, const SensorModel& sensor,
                  const SensorPath& path);
  /// What stands on it, once all scans have said where it is; as DenseMap::insert.
  void insert(const OrganizedCloud& cloud, const std::optional<RowSelection>& measured_rows,
              const SensorPath& path);
  /// What a scan saw through, and where the ground was seen; as DenseMap::see_through.
  void see_through(const OrganizedCloud& measured, const SensorPath& path);

  /// The cells of which anything is known. Throws Error if there are none, or more than
  /// 400 million in the rectangle about them.
  OccupancyMap map() const;
  /// Whether obstacles were left out because max_voxels were reached.
  bool is_full() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Writes an image as Nav2's map_server reads it (PGM, binary): 254 free, 0 occupied, 205 unknown.
/// Throws Error.
void write_occupancy_image(const OccupancyMap& map, const std::string& path);
/// What map_server must know of it; image: its name, as seen from this file. Throws Error.
void write_occupancy_yaml(const OccupancyMap& map, const std::string& image,
                          const std::string& path);
/// The map of a .yaml file and its image, of mode trinary. Throws Error.
OccupancyMap read_occupancy_map(const std::string& yaml_path);

}  // namespace hqslam::slam
