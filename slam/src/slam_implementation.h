#pragma once

#include <optional>

#include "alignment/drift.h"
#include "front_end/features.h"
#include "front_end/mounting.h"
#include "front_end/odometry.h"
#include "front_end/scan_clock.h"
#include "front_end/segmentation.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/slam.h"
#include "known_way.h"
#include "loops/background_loop_closing.h"
#include "loops/place_recognition.h"
#include "map/mapping.h"
#include "segmented_trajectory.h"
#include "stopwatch.h"

namespace hqslam::slam {

/// What is carried from scan to scan. The reference is the last scan that could be followed.
struct Slam::Implementation {
  SlamOptions options;
  Mounting mounting;
  SensorModel sensor;  ///< the upright one
  Segmenter segmenter;
  Odometry odometry;
  Mapping mapping;
  std::optional<BackgroundLoopClosing> loop_closing;  ///< not in a given map
  SegmentedTrajectory path;
  ScanClock clock;
  double time_s = 0.0;  ///< of the scan at hand
  double reference_time_s = 0.0;
  MotionState reference;
  Pose T_odom_reference = Pose::Identity();
  AccelerationNoise accelerations;
  Drift drift;
  KnownWay way;

  Implementation(const SensorModel& sensor, const SlamOptions& options);

  /// In a map that another drive left behind: how its places are recognized.
  std::optional<PlaceRecognition> place_recognition;
  bool is_recognized = true;  ///< where the sensor is

  void locate_in(const SavedMap& map, const std::optional<Pose>& T_map_level_start);

  /// The first keyframe, until its motion is known.
  struct FirstScan {
    double time_s = 0.0;
    Features features;
    MapFeatures thinned;
  };
  std::optional<FirstScan> first_scan;

  /// What is known of a scan after it was looked for.
  struct Followed {
    MotionState state;
    bool is_registered = false;    ///< in the map
    bool by_odometry = false;      ///< from the reference
    bool is_way_measured = false;  ///< from the reference
    double inlier_ratio = 0.0;     ///< see MappingResult
  };

  ScanReport process(const OrganizedCloud& cloud, double stamp_s);
  ScanReport process_level(const OrganizedCloud& cloud, double stamp_s);
  void begin(const OrganizedCloud& cloud, const Features& features, Stopwatch& stopwatch,
             ScanReport& report);
  void recognize_place(const OrganizedCloud& cloud, const Features& features, Stopwatch& stopwatch,
                       ScanReport& report);
  bool is_in_given_map(const MapFeatures& thinned, const MotionState& state) const;
  void follow(const OrganizedCloud& cloud, const Features& features, Stopwatch& stopwatch,
              ScanReport& report);
  Followed locate(const Features& features, const MapFeatures& thinned, Stopwatch& stopwatch,
                  ScanReport& report) const;
  void correct_first_keyframe(const Twist& velocity);
  /// Whether a scan can serve as the one that the next are matched with: edges alone will do
  /// (indoors), and so will ground and surfaces alone (in open land).
  bool can_be_reference(const Features& features) const;
  void make_reference(const Features& features, const MotionState& state, const ScanReport& report);
  void add_keyframe(const OrganizedCloud& cloud, const MapFeatures& features, Stopwatch& stopwatch,
                    ScanReport& report, bool begins_segment);
  void take_in(const LoopResult& found);
};

}  // namespace hqslam::slam
