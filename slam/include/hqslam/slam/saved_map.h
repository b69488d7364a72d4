#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "hqslam/core/pose.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/scan_context.h"

namespace hqslam::slam {

/// A place that can be recognised.
struct SavedPlace {
  Pose T_map_sensor = Pose::Identity();  ///< of the sensor turned level (Slam::mounting)
  ScanContext context;
};

/// What a drive leaves behind for later ones to be registered in. Everything is in the map's frame,
/// that of the drive's first scan, turned level.
struct SavedMap {
  std::vector<Eigen::Vector3f> edges_m;
  std::vector<Eigen::Vector3f> posts_m;
  std::vector<Eigen::Vector3f> planes_m;
  std::vector<SavedPlace> places;  ///< every few metres of the path
  /// Of each point, not a number where it is not known; empty if none is.
  std::vector<float> edges_intensity = {};
  std::vector<float> posts_intensity = {};
  std::vector<float> planes_intensity = {};
};

/// A map of any point cloud (metres, z up), in its frame: what drives with this sensor through it
/// would have left behind, as far as the cloud tells. Planes are the cloud's own; edges, posts and
/// contexts are those that a virtual sensor sees at places every 4 m on the ground
/// (src/foreign_map/). Throws Error: points not finite or more than 100 km from the origin, too
/// few, or no ground among them; a sensor with one row.
SavedMap map_of_cloud(const std::vector<Eigen::Vector3f>& points_m, const SensorModel& sensor,
                      const SlamOptions& options);

/// An .npz file that numpy reads, too: edges_m, posts_m and planes_m (N x 3, float32, metres),
/// T_map_place (M x 3 x 4, float64) and place_contexts (M x 20 x 60, float32; ScanContext's unit
/// sectors, ring after ring), and edges_intensity and so on (N, float32) where they are not empty.
/// Throws Error; an existing file is replaced once the new one is whole.
void write_saved_map(const std::string& path, const SavedMap& map);
/// Throws Error: not a saved map, or something in it that no drive leaves behind (shapes, numbers
/// that are not finite, rotations that are none).
SavedMap read_saved_map(const std::string& path);

}  // namespace hqslam::slam
