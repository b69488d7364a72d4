#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "hqslam/core/pose.h"
#include "hqslam/slam/scan_context.h"

namespace hqslam::slam {

/// A place that can be recognized.
struct SavedPlace {
  Pose T_map_sensor = Pose::Identity();  ///< of the level frame (Slam::mounting)
  ScanContext context;
};

/// The map of a drive, in which later ones can be located. Frame: that of the drive's first scan,
/// turned level.
struct SavedMap {
  std::vector<Eigen::Vector3f> edges_m;
  std::vector<Eigen::Vector3f> posts_m;
  std::vector<Eigen::Vector3f> planes_m;
  std::vector<SavedPlace> places;  ///< every few metres of the path
  /// One per point, NaN where unknown; empty if none is known.
  std::vector<float> edges_intensity = {};
  std::vector<float> posts_intensity = {};
  std::vector<float> planes_intensity = {};
  /// The share of a scan's features other than ground that were within 0.1 m of the map, mean over
  /// the scans of its drive; 0: unknown.
  double close_ratio = 0.0;
};

/// An .npz file, also for numpy: edges_m, posts_m and planes_m (N x 3, float32, metres),
/// T_map_place (M x 3 x 4, float64) and place_contexts (M x 20 x 60, float32; ScanContext's unit
/// sectors, ring after ring), edges_intensity and so on (N, float32) where they are not empty, and
/// close_ratio (1, float64) where it is known.
/// Throws Error; an existing file is replaced once the new one is complete.
void write_saved_map(const std::string& path, const SavedMap& map);
/// Throws Error if the file is not a saved map or has impossible values (shapes, numbers that are
/// not finite, matrices that are no rotations).
SavedMap read_saved_map(const std::string& path);

}  // namespace hqslam::slam
