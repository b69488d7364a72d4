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

/// Between two scans SLAM is in one of four states; process() in slam.cpp makes the transitions:
///
///   Starting  --enough features-->  Tracking  <--registered / not registered-->  Lost
///   Lost for six scans:  without a given map it remains Lost while the odometry measures the
///   motion
///             (and the map goes on), otherwise -> Tracking in a submap of its own;
///             in a given map -> Searching
///   Searching  --place recognized-->  Tracking
///
/// Each state holds only the data that exist in it: Starting, for instance, has no pose.

/// The last scan with a known motion, from which the next is predicted and with which it is
/// matched.
struct Reference {
  double time_s = 0.0;
  MotionState state;
  Matrix6 against_map = Matrix6::Zero();  ///< the pose's covariance: Drift
  Pose T_odom_sensor = Pose::Identity();
  OdometryTarget target;
  double stamp_s = 0.0;
  std::optional<InertialState> inertial;  ///< if inertial data cover the scan
};

/// No scan had enough features yet.
struct Starting {};

/// The first keyframe of a map or submap, inserted as if the sensor stood; once its velocity is
/// known, the map begins again with it, corrected for motion.
struct FirstKeyframe {
  double time_s = 0.0;
  Pose T_map_sensor = Pose::Identity();
  Features measured_features;          ///< before `turning` is applied
  std::optional<EvenTurning> turning;  ///< if inertial data cover the scan
  /// Where the last registration of the scan after it ended; the map has begun anew since.
  std::optional<Pose> T_map_next = {};
};

/// The scan since the last keyframe, at nearly one pose, of which the most is close to the map.
struct BestFit {
  double close_ratio = 0.0;
  Pose T_map_sensor = Pose::Identity();
};

/// The last scan was registered in the map, or is the first of a submap.
struct Tracking {
  Reference reference;
  double inlier_ratio = 0.0;  ///< MappingResult::inlier_ratio of that scan; 0: none yet
  double close_ratio = 0.0;   ///< MappingResult::close_ratio of that scan; 0: none yet
  /// The largest one, which falls by a tenth of its difference from each smaller one.
  double usual_close_ratio = 0.0;
  BestFit best_fit = {};
  std::optional<FirstKeyframe> first_keyframe = {};  ///< while it is the only one and not corrected
};

/// Tracking lost: the last scans were not registered, and the odometry alone follows the sensor.
struct Lost {
  Tracking last;  ///< before tracking was lost; its reference moves with the odometry
  std::size_t missed_scans = 0;
  std::size_t unplaced_scans = 0;  ///< missed scans since the last keyframe
  bool is_motion_measured = true;  ///< by the odometry, for all missed scans
  bool is_carried = false;         ///< a scan contradicted a well known state
};

/// The pose in a given map is unknown, or unknown again.
struct Searching {
  Pose T_map_last = Pose::Identity();   ///< the last known pose, which is reported
  Pose T_odom_last = Pose::Identity();  ///< in the frame of the odometry, which continues
  std::optional<Reference> reference;   ///< for the motion between the scans that are searched
  double usual_close_ratio = 0.0;       ///< Tracking's; 0 before a scan was located
};

using State = std::variant<Starting, Tracking, Lost, Searching>;

std::string_view name(const State& state);  ///< "starting", "tracking", "lost", "searching"

/// nullptr without a reference.
Reference* reference_of(State& state);

/// The output of the front end.
struct Scan {
  const OrganizedCloud& cloud;  ///< of the sensor turned level
  Segmentation segmentation;
  double time_s = 0.0;     ///< ScanClock
  double stamp_s = 0.0;    ///< by the clock of the inertial sensor, if there is one
  Features features = {};  ///< with `turning` applied
  MapFeatures map_features = {};
  /// Whether the next scan can be matched with it, by edges alone (indoors) or by ground and
  /// surfaces alone (in open land).
  bool has_enough_features = false;
  std::optional<EvenTurning> turning = std::nullopt;
  Eigen::Vector3d specific_force_mps2 = Eigen::Vector3d::Zero();  ///< with `turning` only
};

}  // namespace hqslam::slam
