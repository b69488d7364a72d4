#pragma once

#include <chrono>
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
#include "imu/inertial_check.h"
#include "loops/background_loop_closing.h"
#include "loops/place_recognition.h"
#include "map/map_fit.h"
#include "map/rooms.h"
#include "segmented_trajectory.h"
#include "states.h"

namespace hqslam::slam {

/// Measures the seconds since construction or since the last call of lap_s().
class Stopwatch {
 public:
  double lap_s() {
    const auto now = std::chrono::steady_clock::now();
    const double elapsed_s = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return elapsed_s;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// What is recorded about the present scan.
struct Notes {
  ScanReport report;
  Stopwatch stopwatch;
  ScanTrace* trace = nullptr;                ///< nullptr: none
  Matrix6 own_covariance = Matrix6::Zero();  ///< Drift::own_covariance
};

/// The result of a registration in the map.
struct Registered {
  MotionState state;  ///< by the map, else by the odometry, else the expected one
  Matrix6 against_map = Matrix6::Zero();
  bool is_registered = false;        ///< in the map
  bool by_odometry = false;          ///< the motion since the reference is known
  bool is_motion_plausible = false;  ///< known, and possible unless the sensor is carried
  bool is_contradiction = false;     ///< of a state that was well known before the scan
  bool has_near_ground = false;      ///< MappingResult::has_near_ground
  double inlier_ratio = 0.0;
  double close_ratio = 0.0;
  std::optional<InertialState> inertial;
  double innovation = 0.0;  ///< normalized_innovation() of the inertial prediction
};

class OdometryOnDemand;

struct Slam::Implementation {
  SlamOptions options;
  Mounting mounting;
  SensorModel sensor;  ///< the upright one
  ScanClock clock;
  ImuBuffer imu;
  InertialCheck inertial_check;
  State state;
  RoomCheck rooms;
  Mapping mapping;
  SegmentedTrajectory path;
  GravityWindow gravity_window;
  AccelerationNoise accelerations;
  Drift drift;
  // Exactly one of the two:
  std::optional<BackgroundLoopClosing> loop_closing;  ///< without a given map
  std::optional<PlaceRecognition> place_recognition;  ///< in a given map
  MapFit map_fit;

  Implementation(const SensorModel& sensor, const SlamOptions& options, const SavedMap* given_map,
                 const std::optional<Pose>& T_map_level_start);

  // slam.cpp
  ScanReport process(const OrganizedCloud& cloud, double stamp_s, ScanTrace* trace);
  Notes process_level(const OrganizedCloud& cloud, double stamp_s, ScanTrace* trace);
  void collect_loops(Notes& notes);
  void apply(const LoopResult& found);
  void apply(const LoopedDrift& found, const Pose& T_map_reference);
  void make_turning_even(Scan& scan);
  Segmentation segmented(const OrganizedCloud& cloud, double time_s);
  Features measured_features(const Scan& scan) const;
  Scan front_end(const OrganizedCloud& cloud, double stamp_s, Notes& notes);

  // The next state after a scan: tracking.cpp; for Searching relocalization.cpp.
  State next(Starting now, const Scan& scan, Notes& notes);
  State next(Tracking now, Scan& scan, Notes& notes);
  State next(Lost now, Scan& scan, Notes& notes);
  State next(Searching now, const Scan& scan, Notes& notes);

  // The registration of a scan from its reference: registration.cpp.
  std::optional<InertialPrediction> predicted_by_imu(const Reference& reference,
                                                     const Scan& scan) const;
  Registered judged(const Tracking& last, const Scan& scan, const MotionState& expected,
                    const MappingResult& matched, OdometryOnDemand& odometry) const;
  std::optional<InertialState> inertial_after(const Reference& reference,
                                              const std::optional<InertialPrediction>& measured,
                                              const MappingResult& matched,
                                              const Registered& found) const;
  void put_report(const Reference& reference, const Scan& scan, const MappingResult& matched,
                  const Registered& found, Notes& notes) const;
  Registered registered(const Tracking& last, const Scan& scan, Notes& notes) const;

  // With an inertial sensor: tracking_by_imu.cpp.
  void leave_out_imu(Scan& scan) const;
  Registered checked(const Tracking& last, Scan& scan, Notes& notes);
  bool replaced_without_imu(const Tracking& last, double least_gain, Scan& scan, Registered& found,
                            Notes& notes);
  void compare_turns(const Reference& reference, const Scan& scan, Registered& found);
  Registered first_registered(Tracking& last, Scan& scan, Notes& notes);

  // tracking.cpp
  FirstKeyframe first_keyframe_of(const Scan& scan, const Pose& T_map_sensor) const;
  Registered in_corrected_map(Tracking& last, Scan& scan, Notes& notes);
  State tracked(Tracking last, const Registered& found, const Scan& scan, Notes& notes);
  bool is_keyframe(Tracking& last, const Pose& T_map_sensor) const;
  State new_segment(const Lost& lost, Registered found, const Scan& scan, Notes& notes);
  Features put_first_keyframe(const FirstKeyframe& first, const Twist& velocity);
  void correct_first_keyframe(Tracking& last, Twist velocity);
  void add_keyframe(const Scan& scan, const ScanMotion& motion, bool begins_segment, Notes& notes);
  bool is_in_given_map(const MapFeatures& features, const MotionState& found) const;
};

/// A reference made of a scan. inertial: nothing if it begins with this scan or no data cover it.
Reference reference_of(const Scan& scan, const MotionState& state, const Matrix6& against_map,
                       const ScanReport& report, std::optional<InertialState> inertial = {});

}  // namespace hqslam::slam
