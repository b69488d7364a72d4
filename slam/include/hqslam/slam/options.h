#pragma once

namespace hqslam::slam {

/// Angles in radians, lengths in metres. Every default is LeGO-LOAM's unless it says otherwise;
/// validate() has the bounds.

struct GroundOptions {
  double max_slope_rad = 0.17453292519943295;  ///< 10 degrees
};

struct SegmentationOptions {
  double min_angle_rad = 1.0471975511965976;  ///< 60 degrees: see ConnectedComponentsOptions
  int min_pixels = 30;                        ///< a cluster of so many pixels is kept,
  int min_pixels_tall = 5;                    ///< or of so many
  int min_rows_tall = 3;                      ///< over so many rows
};

struct FeatureOptions {
  int sections = 6;                 ///< equal parts of a row from which features are drawn
  int sharp_edges_per_section = 2;  ///< matched from scan to scan
  int edges_per_section = 20;       ///< matched against, and put into the map
  int flat_points_per_section = 4;  ///< of the ground, matched from scan to scan
  /// Smoothness |sum of 10 neighbours' ranges - 10 range|: an edge has more than both of these,
  /// a flat point less than the first.
  double min_edge_smoothness_m = 0.31622776601683794;
  double min_edge_smoothness_per_range = 0.02;  ///< LeGO-LOAM has none
  double planar_leaf_m = 0.2;
  double max_post_width_m = 1.0;  ///< LeGO-LOAM has no posts
};

struct OdometryOptions {
  int max_iterations = 8;  ///< LeGO-LOAM: 25; see Odometry for what its steps are
  int min_edges = 10;
  int min_planar = 100;
  int min_correspondences = 10;
  double max_distance_m = 5.0;
  double converged_rotation_rad = 0.0017453292519943296;  ///< 0.1 degrees
  double converged_translation_m = 0.005;                 ///< LeGO-LOAM: 0.001; mapping refines it
};

struct MappingOptions {
  int max_iterations = 10;
  int min_correspondences = 50;
  /// A scan of which less fits the map is not of this place. Measured: streets 0.47 and more, noise
  /// 0.2. LeGO-LOAM has none.
  double min_matched_share = 0.25;
  double edge_leaf_m = 0.2;
  double planar_leaf_m = 0.4;
  double located_planar_leaf_m = 0.8;     ///< of the scan that is located; LeGO-LOAM: as in the map
  double max_neighbour_distance_m = 1.0;  ///< of the first two searches
  double close_neighbour_distance_m = 0.6;  ///< of those that follow, where it finds enough;
                                            ///< LeGO-LOAM: 1 m for all
  /// Of a feature from its line or plane: a scan's weights begin to fall from there, in the
  /// searches of close_neighbour_distance_m; LeGO-LOAM: by 0.09 for 0.1 m.
  double trusted_residual_m = 0.05;
  double max_plane_residual_m = 0.2;    ///< of the five points of a plane
  double max_ground_residual_m = 0.05;  ///< LeGO-LOAM: 0.2 for the ground too
  /// The map is matched with as far as the last so many metres of path saw it, or a loop was
  /// verified there; LeGO-LOAM: all of it.
  double recent_path_m = 200.0;
  double key_frame_translation_m = 0.3;
  double key_frame_rotation_rad = 0.2;  ///< LIO-SAM's; LeGO-LOAM has no key frame for a turn
  double converged_rotation_rad = 0.0008726646259971648;  ///< 0.05 degrees
  double converged_translation_m = 0.0005;
};

struct LoopClosingOptions {
  bool enabled = false;
};

struct SlamOptions {
  int threads = 0;  ///< 0: what OpenMP would take
  GroundOptions ground;
  SegmentationOptions segmentation;
  FeatureOptions features;
  OdometryOptions odometry;
  MappingOptions mapping;
  LoopClosingOptions loop_closing;
};

/// Throws Error with field, value and constraint.
void validate(const SlamOptions& options);

}  // namespace hqslam::slam
