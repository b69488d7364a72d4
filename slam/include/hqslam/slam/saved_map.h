#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "hqslam/core/pose.h"
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

/// An .npz file that numpy reads, too: edges_m, posts_m and planes_m (N x 3, float32, metres),
/// T_map_place (M x 3 x 4, float64) and place_contexts (M x 20 x 60, float32; ScanContext's unit
/// sectors, ring after ring), and edges_intensity and so on (N, float32) where they are not empty.
/// Throws Error; an existing file is replaced once the new one is whole.
void write_saved_map(const std::string& path, const SavedMap& map);
/// Throws Error: not a saved map, or something in it that no drive leaves behind (shapes, numbers
/// that are not finite, rotations that are none).
SavedMap read_saved_map(const std::string& path);

}  // namespace hqslam::slam
