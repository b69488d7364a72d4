#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <variant>

#include "alignment/motion_state.h"
#include "front_end/features.h"
#include "front_end/odometry.h"
#include "imu/even_turning.h"
#include "imu/inertial_state.h"
#include "map/mapping.h"

namespace hqslam::slam {

/// What SLAM knows of the sensor between two scans is one of four states; process() in slam.cpp
/// takes a scan from one to the next:
///
///   Starting  --enough features-->  Tracking  <--registered / not registered-->  Lost
///   Lost, six scans in a row:  in a map of its own it stays Lost while the odometry measures the
///             motion (and the map goes on), otherwise -> Tracking in a submap of its own;
///             in a given map -> Searching
///   Searching  --place recognized-->  Tracking
///
/// Each holds what follows from it and no more: a new segment's Tracking knows no inlier ratio, and
/// a sensor that is Starting has no pose.

/// The last scan whose motion is known: what the next is predicted from and matched with.
struct Reference {
  double time_s = 0.0;
  MotionState state;
  Matrix6 against_map = Matrix6::Zero();  ///< the pose's covariance: Drift
  Pose T_odom_sensor = Pose::Identity();
  OdometryTarget target;
  double stamp_s = 0.0;
  std::optional<InertialState> inertial;  ///< where an inertial sensor covers the scan
};

/// Nothing was seen yet that SLAM could begin with.
struct Starting {};

/// The first keyframe, taken as if the sensor stood: once its velocity is known, the map begins
/// anew with it, corrected for motion.
struct FirstKeyframe {
  double time_s = 0.0;
  Features features;
  MapFeatures map_features;
  std::optional<EvenTurning> turning;  ///< where an inertial sensor saw how it turned
};

/// The last scan was registered in the map, or is the first of a submap.
struct Tracking {
  Reference reference;
  double inlier_ratio = 0.0;  ///< of that scan, MappingResult::inlier_ratio; 0: nothing yet
  double close_ratio = 0.0;   ///< the same, MappingResult::close_ratio
  std::optional<FirstKeyframe> first_keyframe;  ///< while it is the only one and not corrected
};

/// The last scans were not registered: the odometry alone follows the sensor, as far as it can.
struct Lost {
  Tracking last;  ///< when it was tracked; its reference goes on with the odometry
  std::size_t missed_scans = 0;
  std::size_t unplaced_scans = 0;  ///< of those, since the map last went on
  bool is_motion_measured = true;  ///< by the odometry, from scan to scan, all the way
  bool is_carried = false;         ///< a scan contradicted what was well known
};

/// In a given map: where the sensor is is not known, or not any more.
struct Searching {
  Pose T_map_last = Pose::Identity();   ///< the last known pose, which stands
  Pose T_odom_last = Pose::Identity();  ///< the odometry's frame goes on
  std::optional<Reference> reference;   ///< so that scans can be moved together
};

using State = std::variant<Starting, Tracking, Lost, Searching>;

std::string_view name(const State& state);  ///< "starting", "tracking", "lost", "searching"

/// nullptr where no scan is followed.
Reference* reference_of(State& state);

/// A scan as the front end leaves it.
struct Scan {
  const OrganizedCloud& cloud;  ///< of the sensor turned level
  double time_s = 0.0;          ///< ScanClock
  Features features;
  MapFeatures map_features;
  /// Whether the next scan can be matched with it: edges alone will do (indoors), and so will
  /// ground and surfaces alone (in open land).
  bool has_enough_features = false;
  double stamp_s = 0.0;  ///< by the clock of the inertial sensor, if there is one
  std::optional<EvenTurning> turning;
  Eigen::Vector3d specific_force_mps2 = Eigen::Vector3d::Zero();  ///< where there is a turning
};

}  // namespace hqslam::slam
