#pragma once

#include <optional>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/saved_map.h"
#include "loops/loop_search.h"
#include "map/mapping.h"
#include "map/recent_features.h"

namespace hqslam::slam {

/// A scan whose place is sought.
struct UnregisteredScan {
  const OrganizedCloud& cloud;
  const MapFeatures& features;
  /// The motion from the scan before, which was not found either; nothing: unknown.
  std::optional<Pose> T_previous_sensor;
  Twist velocity;  ///< per second
};

/// Finds a sensor among the places of a saved map.
///
/// The features of its last scans, moved together by the odometry, are compared with the places as
/// in loop closing: with all places and headings (search_similar_places), or within 10 m and half a
/// radian of an initial pose (search_loop). Where they match no place, those of the last scan alone
/// are: the odometry fails in a hand that measures once a second. A standing sensor needs one scan.
/// The scans of a moving one are distorted until its velocity is known.
class PlaceRecognition {
 public:
  PlaceRecognition(const MappingOptions& options, const std::vector<SavedPlace>& places,
                   const std::optional<Pose>& T_map_sensor_start);

  /// The pose of the scan; nothing if no place fits well, or two do.
  std::optional<Pose> find(const UnregisteredScan& scan, const FeatureMaps& map);

  /// Drops the initial pose and the last scans.
  void forget();

 private:
  /// Chosen in simulation and on real recordings (weights/NOTEBOOK.md, "What the odometry is for").
  static constexpr std::size_t kRecentScans = 5;

  MappingOptions options_;
  /// The places, then the sensor at its estimated pose or, without an initial one, in a frame of
  /// its own.
  PoseGraph graph_;
  std::vector<ScanContext> contexts_;
  std::vector<std::size_t> places_;  ///< their nodes
  bool has_start_;
  RecentFeatures recent_{kRecentScans};
};

}  // namespace hqslam::slam
