#include "hqslam/slam/options.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "hqslam/core/error.h"

namespace hqslam::slam {

namespace {

struct Constraint {
  bool (*holds)(double value);
  const char* expected;
};

constexpr Constraint kPositive{[](double value) { return value > 0.0 && std::isfinite(value); },
                               "a positive number"};
constexpr Constraint kNotNegative{[](double value) { return value >= 0.0 && std::isfinite(value); },
                                  "0 or a positive number"};
constexpr Constraint kAcute{
    [](double value) { return value > 0.0 && value < std::numbers::pi / 2.0; },
    "an angle between 0 and pi/2"};
constexpr Constraint kShare{[](double value) { return value >= 0.0 && value < 1.0; },
                            "a share from 0 to 1"};
/// A row of 16384 pixels times its sections is still an int.
constexpr Constraint kSections{[](double value) { return value >= 1.0 && value <= 1000.0; },
                               "1 to 1000"};
/// Thinning reaches a million voxels far: 1 km.
constexpr Constraint kLeaf{[](double value) { return value >= 0.001 && std::isfinite(value); },
                           "0.001 or more"};

constexpr int kMostThreads = 256;

struct Field {
  const char* name;
  double value;
  Constraint constraint;
};

void require(bool holds, const char* name, double value, const char* expected) {
  if (!holds) throw Error(fmt::format("SLAM option {} is {}, expected {}", name, value, expected));
}

void require_all(const std::vector<Field>& fields) {
  for (const Field& field : fields) {
    require(field.constraint.holds(field.value), field.name, field.value,
            field.constraint.expected);
  }
}

std::vector<Field> fields_of(const SegmentationOptions& options) {
  return {{"segmentation.min_angle_rad", options.min_angle_rad, kAcute},
          {"segmentation.min_pixels", 1.0 * options.min_pixels, kPositive},
          {"segmentation.min_pixels_tall", 1.0 * options.min_pixels_tall, kPositive},
          {"segmentation.min_rows_tall", 1.0 * options.min_rows_tall, kPositive}};
}

std::vector<Field> fields_of(const FeatureOptions& options) {
  return {{"features.sections", 1.0 * options.sections, kSections},
          {"features.sharp_edges_per_section", 1.0 * options.sharp_edges_per_section, kPositive},
          {"features.edges_per_section", 1.0 * options.edges_per_section, kPositive},
          {"features.flat_points_per_section", 1.0 * options.flat_points_per_section, kPositive},
          {"features.min_edge_smoothness_m", options.min_edge_smoothness_m, kNotNegative},
          {"features.min_edge_smoothness_per_range", options.min_edge_smoothness_per_range,
           kNotNegative},
          {"features.planar_leaf_m", options.planar_leaf_m, kLeaf},
          {"features.max_post_width_m", options.max_post_width_m, kNotNegative}};
}

std::vector<Field> fields_of(const OdometryOptions& options) {
  return {{"odometry.max_iterations", 1.0 * options.max_iterations, kPositive},
          {"odometry.min_edges", 1.0 * options.min_edges, kPositive},
          {"odometry.min_planar", 1.0 * options.min_planar, kPositive},
          {"odometry.min_correspondences", 1.0 * options.min_correspondences, kPositive},
          {"odometry.max_distance_m", options.max_distance_m, kPositive},
          {"odometry.converged_rotation_rad", options.converged_rotation_rad, kNotNegative},
          {"odometry.converged_translation_m", options.converged_translation_m, kNotNegative}};
}

std::vector<Field> fields_of(const MappingOptions& options) {
  return {{"mapping.max_iterations", 1.0 * options.max_iterations, kPositive},
          {"mapping.min_correspondences", 1.0 * options.min_correspondences, kPositive},
          {"mapping.min_matched_share", options.min_matched_share, kShare},
          {"mapping.edge_leaf_m", options.edge_leaf_m, kLeaf},
          {"mapping.planar_leaf_m", options.planar_leaf_m, kLeaf},
          {"mapping.located_planar_leaf_m", options.located_planar_leaf_m, kLeaf},
          {"mapping.max_neighbour_distance_m", options.max_neighbour_distance_m, kPositive},
          {"mapping.close_neighbour_distance_m", options.close_neighbour_distance_m, kPositive},
          {"mapping.trusted_residual_m", options.trusted_residual_m, kPositive},
          {"mapping.max_plane_residual_m", options.max_plane_residual_m, kPositive},
          {"mapping.max_ground_residual_m", options.max_ground_residual_m, kPositive},
          {"mapping.recent_path_m", options.recent_path_m, kPositive},
          {"mapping.key_frame_translation_m", options.key_frame_translation_m, kNotNegative},
          {"mapping.key_frame_rotation_rad", options.key_frame_rotation_rad, kNotNegative},
          {"mapping.converged_rotation_rad", options.converged_rotation_rad, kNotNegative},
          {"mapping.converged_translation_m", options.converged_translation_m, kNotNegative}};
}

}  // namespace

void validate(const SlamOptions& options) {
  const MappingOptions& mapping = options.mapping;
  require(options.threads >= 0 && options.threads <= kMostThreads, "threads", options.threads,
          "0 to 256");
  require_all({{"ground.max_slope_rad", options.ground.max_slope_rad, kAcute}});
  require_all(fields_of(options.segmentation));
  require_all(fields_of(options.features));
  require_all(fields_of(options.odometry));
  require_all(fields_of(mapping));
  require(options.features.edges_per_section >= options.features.sharp_edges_per_section,
          "features.edges_per_section", options.features.edges_per_section,
          "at least features.sharp_edges_per_section");
  require(mapping.close_neighbour_distance_m <= mapping.max_neighbour_distance_m,
          "mapping.close_neighbour_distance_m", mapping.close_neighbour_distance_m,
          "at most mapping.max_neighbour_distance_m");
  for (const auto& [name, leaf_m] : {std::pair{"mapping.edge_leaf_m", mapping.edge_leaf_m},
                                     {"mapping.planar_leaf_m", mapping.planar_leaf_m}}) {
    // A cube of the map numbers its voxels with 16 bits.
    require(leaf_m >= mapping.max_neighbour_distance_m / 20.0, name, leaf_m,
            "at least a twentieth of mapping.max_neighbour_distance_m");
  }
}

}  // namespace hqslam::slam
