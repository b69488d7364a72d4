#include "hqslam/slam/options.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "hqslam/core/error.h"

namespace hqslam::slam {

namespace {

void require(bool holds, const char* field, double value, const char* constraint) {
  if (!holds) {
    throw Error(fmt::format("SLAM option {} is {}, expected {}", field, value, constraint));
  }
}

void require_positive(const char* field, double value) {
  require(value > 0.0 && std::isfinite(value), field, value, "a positive number");
}

void require_acute(const char* field, double value) {
  require(value > 0.0 && value < std::numbers::pi / 2.0, field, value,
          "an angle between 0 and pi/2");
}

}  // namespace

void validate(const SlamOptions& options) {
  require_acute("ground.max_slope_rad", options.ground.max_slope_rad);
  require_acute("segmentation.min_angle_rad", options.segmentation.min_angle_rad);
  require_positive("segmentation.min_pixels", options.segmentation.min_pixels);
  require_positive("features.sections", options.features.sections);
  require_positive("features.sharp_edges_per_section", options.features.sharp_edges_per_section);
  require(options.features.edges_per_section >= options.features.sharp_edges_per_section,
          "features.edges_per_section", options.features.edges_per_section,
          "at least features.sharp_edges_per_section");
  require_positive("features.flat_points_per_section", options.features.flat_points_per_section);
  require_positive("features.planar_leaf_m", options.features.planar_leaf_m);
  require_positive("odometry.max_iterations", options.odometry.max_iterations);
  require_positive("odometry.max_distance_m", options.odometry.max_distance_m);
  require_positive("mapping.max_iterations", options.mapping.max_iterations);
  require(options.mapping.min_matched_share >= 0.0 && options.mapping.min_matched_share < 1.0,
          "mapping.min_matched_share", options.mapping.min_matched_share, "a share from 0 to 1");
  require_positive("mapping.max_neighbour_distance_m", options.mapping.max_neighbour_distance_m);
  require_positive("mapping.close_neighbour_distance_m",
                   options.mapping.close_neighbour_distance_m);
  require_positive("mapping.recent_path_m", options.mapping.recent_path_m);
  require_positive("mapping.trusted_residual_m", options.mapping.trusted_residual_m);
  require_positive("mapping.max_plane_residual_m", options.mapping.max_plane_residual_m);
  require_positive("mapping.max_ground_residual_m", options.mapping.max_ground_residual_m);
  for (const auto& [field, leaf_m] : {std::pair{"mapping.edge_leaf_m", options.mapping.edge_leaf_m},
                                      {"mapping.planar_leaf_m", options.mapping.planar_leaf_m}}) {
    // A cube of the map numbers its voxels with 16 bits.
    require(leaf_m >= options.mapping.max_neighbour_distance_m / 20.0 && std::isfinite(leaf_m),
            field, leaf_m, "at least a twentieth of mapping.max_neighbour_distance_m");
  }
}

}  // namespace hqslam::slam
