#pragma once

#include <optional>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/slam/saved_map.h"
#include "loops/loop_search.h"
#include "map/mapping.h"
#include "map/recent_features.h"

namespace hqslam::slam {

/// A scan that is looked for in a map.
struct UnregisteredScan {
  const OrganizedCloud& cloud;
  const MapFeatures& features;
  /// From the scan before, which was not found either; nothing: not known.
  std::optional<Pose> T_previous_sensor;
  Twist velocity;  ///< per second
};

/// Finds a sensor among the places of a saved map that knows nothing, or nearly nothing, about
/// where it is.
///
/// What it saw over its last scans, moved together by the odometry, is compared with the places as
/// loops are (search_similar_places), among all places and turns; or, about where the sensor is
/// believed to be, within 10 m and half a radian (search_loop). One scan will do for a sensor that
/// stands. One that drives sees its surroundings bent until its velocity is known.
class PlaceRecognition {
 public:
  PlaceRecognition(const MappingOptions& options, const std::vector<SavedPlace>& places,
                   const std::optional<Pose>& T_map_sensor_believed);

  /// Where the scan was taken; nothing if no place fits well, or two do.
  std::optional<Pose> find(const UnregisteredScan& scan, const FeatureMaps& map);

  /// The next scan may be anywhere.
  void forget();

 private:
  static constexpr std::size_t kRecentScans = 5;

  MappingOptions options_;
  /// The places, then the sensor where it is believed to be; where nothing is believed, in a frame
  /// of its own.
  PoseGraph graph_;
  std::vector<ScanContext> contexts_;
  std::vector<std::size_t> places_;  ///< their nodes
  bool is_believed_;
  RecentFeatures recent_{kRecentScans};
};

}  // namespace hqslam::slam
