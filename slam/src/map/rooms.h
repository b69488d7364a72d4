#pragma once

#include <optional>
#include <vector>

#include "front_end/features.h"
#include "hqslam/slam/options.h"

namespace hqslam::slam {

/// Whether the sensor is in rooms.
///
/// In: the surfaces of each scan. In rooms, where half of them are within 5 m, a voxel of streets
/// covers parts of several pieces of furniture, and five neighbours half a metre apart are on none.
/// The median ranges of the scans of a second or two are averaged, so that a passage or a gate
/// changes nothing. They are 6 m and more in streets and alleys, and 3.4 to 6.2 m, mostly 4.5 m, in
/// rooms (simulated drives).
class RoomCheck {
 public:
  /// Returns whether is_in_room() has changed.
  bool add(const std::vector<FeaturePoint>& surfaces);
  bool is_in_room() const { return is_in_room_; }

 private:
  std::optional<float> range_m_;  ///< the mean of the medians
  bool is_in_room_ = false;
};

/// The options of mapping in rooms: half of the voxels' size, planes that are flat to a quarter of
/// the distance.
MappingOptions in_rooms(MappingOptions options);

}  // namespace hqslam::slam
