#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "hqslam/core/pose.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/sim/drive.h"
#include "hqslam/slam/occupancy_grid.h"

namespace hqslam::tools {

/// A key of the cube of this side that contains a point, unique within 2^20 sides.
template <typename Length>
std::uint64_t voxel_key(const Eigen::Vector3f& point_m, Length side_m) {
  const auto part = [&](float metres) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(metres / side_m))) &
           0x1FFFFFU;
  };
  return part(point_m.x()) << 42U | part(point_m.y()) << 21U | part(point_m.z());
}

/// Share of the elements for which `is_so` is true, 0 to 1; 0 where there are none.
template <typename Things, typename IsSo>
double share_of(const Things& things, const IsSo& is_so) {
  const auto count = static_cast<double>(std::ranges::count_if(things, is_so));
  return things.empty() ? 0.0 : count / static_cast<double>(things.size());
}

/// A simulated drive and its city.
struct TrueDrive {
  std::string folder;  ///< with its scans
  sim::DriveSpec spec;
  SensorModel sensor;
  Trajectory truth;
};

/// Cells whose true state is certain: their centres in the frame of the truth, up to 20 m from the
/// sensor, each once.
struct TrueCells {
  std::vector<Eigen::Vector3f> empty_m;     ///< the ground is visible, nothing stands above it
  std::vector<Eigen::Vector3f> standing_m;  ///< a surface is visible that stands there
  std::vector<Eigen::Vector3f> moving_m;    ///< nothing stands there, but scans have points
};
/// Throws Error.
TrueCells true_cells(const TrueDrive& drive, double cell_m);

/// Shares, 0 to 1.
struct OccupancyGridError {
  // Of the true cells of each kind:
  double empty_is_free = 0.0;
  double empty_is_occupied = 0.0;
  double standing_is_occupied = 0.0;
  double standing_is_near = 0.0;  ///< an occupied cell within one cell
  double standing_is_free = 0.0;
  double moving_is_occupied = 0.0;
  // Of the grid's cells:
  double free_is_wrong = 0.0;      ///< free, where something stands
  double occupied_is_wrong = 0.0;  ///< occupied, without a standing thing within 1.5 cells
};
/// T_truth_map: from the grid's frame.
OccupancyGridError occupancy_grid_error(const slam::OccupancyMap& map, const Pose& T_truth_map,
                                        const TrueCells& cells, const TrueDrive& drive);

}  // namespace hqslam::tools
