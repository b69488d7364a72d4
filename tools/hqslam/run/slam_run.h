#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/sensor_model.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "hqslam/slam/slam.h"
#include "recording/reading.h"
#include "recording/reference.h"
#include "run/kept_scans.h"

namespace hqslam::tools {

/// One processed scan.
struct ScanRecord {
  std::int64_t scan = 0;  ///< of the recording, counted from 0; those that were left out count
  slam::ScanReport report;
  double reading_s = 0.0;  ///< reading and projecting the file
  /// Filling the missing rows and making points of them, with what a memory recalls and keeps.
  double upsampling_s = 0.0;
  std::int64_t invalid_points = 0;
  /// For a sensor that sends now: from the packet that completed the scan to its pose.
  std::optional<double> latency_s;
};

/// Errors of beams that the beginning of a run's path determined. A run of a recording corrects
/// them, a live one prints what to do.
struct BeamsOfRun {
  SensorModel sensor;  ///< of the recording, with corrections
  double path_m = 0.0;
  double residual_before_m = 0.0;  ///< slam::BeamCalibration
  double residual_after_m = 0.0;
};

/// A run of SLAM over a recording or a sensor, finished or not.
struct SlamRun : Reading {
  std::string command = "run";  ///< the subcommand that made it
  std::string input;
  SensorModel sensor;        ///< of the scans that SLAM took in: upsampled ones have all its rows
  std::string upsampled_by;  ///< nn::Upsampler::name(); empty: the recording as it is
  std::optional<BeamsOfRun> found_beams;  ///< nothing: no errors were found
  slam::SlamOptions slam;
  slam::MountingOptions mounting;  ///< slam::Slam::mounting()
  int threads = 1;
  /// Or that have come from a sensor; nothing as long as only the end of the recording tells.
  std::optional<std::int64_t> scans_in_recording;
  std::vector<ScanRecord> scans;
  std::size_t imu_samples = 0;               ///< that SLAM was given
  std::string imu_complaint;                 ///< slam::Slam::imu_complaint()
  std::string own_parts;                     ///< pipeline::OwnParts::text()
  std::vector<slam::LoopReport> loops;       ///< places that were recognized, and are right now
  std::vector<std::size_t> submap_of_scan;   ///< slam::Slam::submap_of_scan()
  std::vector<std::size_t> segment_of_scan;  ///< slam::Slam::segment_of_scan()
  Trajectory trajectory;  ///< T_map_sensor, the map's frame is the first scan's, turned level
  /// Filled when the run ends: the submap with most scans, and its
  /// points in the map's frame. Relative poses of other submaps are unknown.
  std::size_t largest_submap = 0;
  std::vector<Eigen::Vector3f> map_points_m;
  std::vector<float> map_intensity;  ///< of each; empty where the recording has none
  std::vector<KeptScan> kept_scans;  ///< for the report; filled when the run ends
  std::string located_in;  ///< the file of the map that it was located in; empty: it made its own
  std::optional<slam::SavedMap> saved_map;  ///< filled when the run ends, if it was asked for
  double wall_s = 0.0;
  std::optional<ReferenceComparison> comparison;  ///< once the run has ended, of one with a truth
  std::string dense_map_summary;                  ///< empty: there is none
  std::string occupancy_grid_summary;             ///< the same
  std::vector<std::string> failed_maps;           ///< of these two: why one could not be made
};

/// Over the whole run: reading, upsampling, SLAM and writing.
double scans_per_second(const SlamRun& run);

/// One time of every scan, in milliseconds.
struct ScanTimes {
  std::string name;
  std::vector<double> times_ms;
};
ScanTimes scan_times(const SlamRun& run, std::string_view name,
                     const std::function<double(const ScanRecord&)>& seconds);
/// Times of the stages in their order: "reading", "upsampling" if there was any, and
/// SLAM's.
std::vector<ScanTimes> stage_times(const SlamRun& run);
/// Times of all of SLAM.
ScanTimes slam_times(const SlamRun& run);

/// How many scans a stage ended with each status: all statuses, kOk first.
std::vector<std::pair<slam::Status, std::int64_t>> status_counts(
    const SlamRun& run, slam::Status slam::ScanReport::*status);

/// How often the path and the map were corrected.
std::int64_t loops_closed(const SlamRun& run);

/// Whether the motion from a scan to the next is known: both places were recognized,
/// and the sensor was not carried in between, also where its submaps were joined later.
bool is_motion_known(const SlamRun& run, std::size_t scan);

/// Whether any scan was located in the map of `located_in`.
bool is_located(const SlamRun& run);

/// The scan of the recording of each pose of the trajectory (ScanRecord::scan).
std::vector<std::int64_t> scan_of_pose(const SlamRun& run);

/// The path as far as it is known, in metres.
double known_path_m(const SlamRun& run);

/// The number of scans of each submap (slam::Slam::submap_of_scan), by its number.
std::map<std::size_t, std::int64_t> scans_of_submaps(const SlamRun& run);

}  // namespace hqslam::tools
