#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/pose.h"
#include "hqslam/slam/occupancy_grid.h"
#include "pages/drive_scans.h"

namespace hqslam::tools {

/// Points under a name, in metres. confidence: 0 to 1 for each point, or empty where the source has
/// none; intensity: one for each point in any unit, or empty.
struct ViewCloud {
  std::string name;
  std::vector<Eigen::Vector3f> points_m;
  std::vector<float> confidence = {};
  std::vector<float> intensity = {};
};

/// The last scan of a sensor that sends now, in the frame of the clouds.
struct ViewScan {
  std::string name;
  Pose T_map_sensor = Pose::Identity();
  ViewCloud measured;
};

/// The path of a sensor, in pieces: the relative pose of two pieces is unknown.
struct ViewPath {
  std::string name;
  std::vector<std::vector<Eigen::Vector3f>> pieces_m = {};
};

/// An occupancy grid, and what is written beside its picture.
struct ViewGrid {
  slam::OccupancyMap map;
  std::string summary;
};

/// What a view shows: everything in one frame, z upwards.
struct TurningView {
  std::vector<ViewCloud> clouds;  ///< one is shown at a time
  std::vector<ViewPath> paths;    ///< all are shown, each in its colour
  std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> loops_m;  ///< places that are the same
  std::optional<ViewScan> last_scan = {};
  ViewDrive drive = {};
  std::optional<ViewGrid> grid = {};
};

/// What a page may have of points of 4 bytes (5 with an intensity), so that it stays below 11 MB
/// without its scans.
inline constexpr std::size_t kMostCloudPoints = 1'200'000;

/// What a page may have of an occupancy grid: cells of twice, three times, ... the side, so that
/// there are at most `most_cells`. A cell is occupied if one of its own is, else free if one is.
slam::OccupancyMap thinned(const slam::OccupancyMap& map, std::size_t most_cells = 4'000'000);

/// What tools/web/cloud.js shows as a cloud that is turned, moved and zoomed, with the scans over
/// it. Points are thinned to what a page may have.
nlohmann::ordered_json turning_view_json(const TurningView& view);

}  // namespace hqslam::tools
