#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "alignment/motion_state.h"
#include "front_end/features.h"
#include "hqslam/core/pose.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/status.h"
#include "map/feature_maps.h"
#include "map/map_constraints.h"

namespace hqslam::slam {

/// Features of a scan's measured rows, not corrected for motion, thinned to one per voxel.
struct MapFeatures {
  std::vector<FeaturePoint> edges;
  std::vector<FeaturePoint> posts;                 ///< not thinned
  std::vector<FeaturePoint> ground;                ///< as dense as the map
  std::vector<FeaturePoint> surfaces;              ///< as dense as the map
  std::vector<FeaturePoint> posts_to_register;     ///< one of a few neighbouring rows
  std::vector<FeaturePoint> ground_to_register;    ///< fewer, where there are many
  std::vector<FeaturePoint> surfaces_to_register;  ///< fewer, where there are many
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();   ///< Segmentation::up
};
MapFeatures map_features(const Features& features, const MappingOptions& options);

struct MappingResult {
  MotionState state;                      ///< at the scan's stamp
  Matrix6 information = Matrix6::Zero();  ///< of the scan alone about the pose: ScanInformation
  Matrix6 known = Matrix6::Zero();        ///< what of it is no error of normals: KnownInformation
  Status status = Status::kOk;
  int edge_correspondences = 0;
  int planar_correspondences = 0;
  bool has_ground = false;  ///< kMinGroundConstraints were found
  /// As many were found that are not far: far ones alone, as beyond a vehicle's deck, do not tell
  /// height from pitch, and an error of the pitch grows with the path.
  bool has_near_ground = false;
  /// Share of the features other than ground that found a line or plane in the last wide search:
  /// how well the place fits. The ground fits everywhere, and more is found within 1 m than within
  /// 0.6 m.
  double inlier_ratio = 0.0;
  /// Planes of features other than ground, two of a line, that the last search found within 0.1 m.
  int close_planes = 0;
  /// Their share of all lines and planes of these features. Unlike inlier_ratio it distinguishes a
  /// place from one half a metre or five degrees away.
  double close_ratio = 0.0;
  bool is_ambiguous = false;     ///< another place fits as well: register_from_starts()
  bool is_close_search = false;  ///< whether the last search was a narrow one (MapSearch)
};

/// The start of a registration: the expected pose, or one near a recognized place. There wide
/// searches go on until every direction is observable.
enum class SearchFrom { kExpectedPose, kRecognizedPlace };

/// Scan-to-map optimisation, and the map.
///
/// In: thinned features of a scan, a predicted pose. Out: the pose. Each edge feature is
/// matched with the line through its five nearest edge points of the map, each post with the
/// upright line through the nearest one of the map, each planar feature with the plane through its
/// five nearest planar points; all six parameters are estimated, by a Gauss-Newton step to the most
/// likely pose given these and the prediction; search and step alternate until convergence.
/// Source: LOAM, section VI; LeGO-LOAM's mapOptmization.
///
/// Differs from LeGO-LOAM: every scan is matched, not every fourth; the map is one incremental
/// structure (FeatureMap), not rebuilt from keyframes; the weight of a planar feature falls with
/// its distance from the sensor, not from the origin of the map; planes are fitted about their
/// centroid, so that one through the map's origin is possible; lines must be longer and planes
/// wider; the ground constrains height, roll and pitch only, as in the odometry's first step,
/// because a scan's rings on it would hold the sensor back, and only where it is flat; surfaces do
/// not constrain the height where 25 points of the ground match; a rotation makes a keyframe too;
/// the scan is corrected for motion anew with every improved pose; features far from their line or
/// plane lose weight; and points that were not observed over the last metres of path leave a
/// sliding window until they are restored: a place revisited with decimetres of drift would match
/// in part, and tilt or turn the sensor by degrees.
class Mapping {
 public:
  /// first_keyframe: the number of the first that is inserted.
  explicit Mapping(const MappingOptions& options, std::uint32_t first_keyframe = 0);
  /// Registers scans in a given map.
  Mapping(const MappingOptions& options, FeatureMaps map);

  /// In: the expected state with its covariance; the pose from which the search starts.
  MappingResult register_scan(const MapFeatures& features, const MotionState& expected,
                              const Pose& T_map_sensor_start,
                              SearchFrom from = SearchFrom::kExpectedPose) const;

  /// The match of each feature at the found pose, for a trace.
  MapMatches matches(const MapFeatures& features, const MappingResult& found) const;

  /// Whether the pose is far enough from the last one inserted.
  bool is_keyframe(const Pose& T_map_sensor) const;
  void insert(const MapFeatures& features, const Pose& T_map_sensor, const ScanMotion& motion);
  std::uint32_t keyframes() const { return keyframes_; }

  /// Moves the sliding window: takes out the points that were not observed over the last
  /// MappingOptions::recent_path_m.
  MapPoints slide_window();
  /// Takes everything out: the next keyframe is the first of a map of its own.
  MapPoints clear_window();
  /// Puts points back, as if the last keyframe had observed them.
  void restore_to_window(MapPoints points);
  /// Moves every keyframe with its points; in: T_corrected_map of each keyframe.
  void correct(const std::vector<Pose>& corrections);

  const FeatureMaps& map() const { return map_; }
  const MappingOptions& options() const { return options_; }
  /// Changes all options but reaches. A map that grows is put into voxels of the new size, a given
  /// one keeps its points.
  void change_options(const MappingOptions& options);

 private:
  MappingOptions options_;
  FeatureMaps map_;
  bool is_given_ = false;
  std::uint32_t keyframes_ = 0;
  std::deque<double> recent_path_m_;  ///< along the path, of the keyframes matched with
  double path_m_ = 0.0;               ///< up to the last keyframe
  Pose T_map_last_keyframe_ = Pose::Identity();
};

}  // namespace hqslam::slam
