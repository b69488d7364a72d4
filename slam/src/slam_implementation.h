#pragma once

#include <optional>

#include "alignment/drift.h"
#include "front_end/mounting.h"
#include "front_end/scan_clock.h"
#include "front_end/segmentation.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/scan_trace.h"
#include "hqslam/slam/slam.h"
#include "imu/felt_gravity.h"
#include "imu/imu_buffer.h"
#include "loops/background_loop_closing.h"
#include "loops/place_recognition.h"
#include "segmented_trajectory.h"
#include "states.h"
#include "stopwatch.h"

namespace hqslam::slam {

/// What is written down about the scan at hand.
struct Notes {
  ScanReport report;
  Stopwatch stopwatch;
  ScanTrace* trace = nullptr;                ///< nullptr: not asked for
  Matrix6 own_covariance = Matrix6::Zero();  ///< Drift::own_covariance
};

struct Slam::Implementation {
  SlamOptions options;
  Mounting mounting;
  SensorModel sensor;  ///< the upright one
  Segmenter segmenter;
  ScanClock clock;
  ImuBuffer imu;
  State state;
  Mapping mapping;
  SegmentedTrajectory path;
  GravityWindow gravity_window;
  AccelerationNoise accelerations;
  Drift drift;
  Matrix6 own_covariance = Matrix6::Zero();  ///< Drift::own_covariance() of the last scan
  // One of the two:
  std::optional<BackgroundLoopClosing> loop_closing;  ///< of a map of its own
  std::optional<PlaceRecognition> place_recognition;  ///< in a given map

  Implementation(const SensorModel& sensor, const SlamOptions& options, const SavedMap* given_map,
                 const std::optional<Pose>& T_map_level_start);

  // slam.cpp
  ScanReport process(const OrganizedCloud& cloud, double stamp_s, ScanTrace* trace);
  ScanReport process_level(const OrganizedCloud& cloud, double stamp_s, ScanTrace* trace);
  void collect_loops(Notes& notes);
  void apply(const LoopResult& found);
  void apply(const LoopedDrift& found, const Pose& T_map_reference);
  void make_turning_even(Scan& scan);
  Scan front_end(const OrganizedCloud& cloud, double stamp_s, Notes& notes);

  // One scan on, from each state: tracking.cpp, and Searching in relocalization.cpp.
  State next(Starting now, const Scan& scan, Notes& notes);
  State next(Tracking now, const Scan& scan, Notes& notes);
  State next(Lost now, const Scan& scan, Notes& notes);
  State next(Searching now, const Scan& scan, Notes& notes);

  /// A scan after it was looked for in the map.
  struct Registered {
    MotionState state;  ///< by the map, else by the odometry, else as it was expected
    Matrix6 against_map = Matrix6::Zero();
    bool is_registered = false;        ///< in the map
    bool by_odometry = false;          ///< its motion since the reference is known
    bool is_motion_plausible = false;  ///< and is one that a sensor can make that is not carried
    bool is_contradiction = false;     ///< of what was well known before the scan
    double inlier_ratio = 0.0;
    double close_ratio = 0.0;
    std::optional<InertialState> inertial;
  };
  std::optional<InertialPrediction> predicted_by_imu(const Reference& reference,
                                                     const Scan& scan) const;
  Registered judged(const Tracking& last, const Scan& scan, const MotionState& expected,
                    const OdometryResult& moved, const MappingResult& matched) const;
  Registered registered(const Tracking& last, const Scan& scan, Notes& notes) const;
  Registered first_registered(Tracking& last, const Scan& scan, Notes& notes);
  State tracked(Tracking last, const Registered& found, const Scan& scan, Notes& notes);
  State new_segment(const Lost& lost, Registered found, const Scan& scan, Notes& notes);
  void correct_first_keyframe(Tracking& last, Twist velocity);
  void add_keyframe(const Scan& scan, const Twist& velocity, bool begins_segment, Notes& notes);
  bool is_in_given_map(const MapFeatures& features, const MotionState& found) const;
};

/// The scan as the one that the next are matched with. inertial: nothing where it begins with this
/// scan, or nothing covers it.
Reference reference_of(const Scan& scan, const MotionState& state, const Matrix6& against_map,
                       const ScanReport& report, std::optional<InertialState> inertial = {});

}  // namespace hqslam::slam
