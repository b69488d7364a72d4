#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/nn/upsampler.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "hqslam/slam/slam.h"
#include "recording/recording_sensor.h"
#include "terminal/interrupt.h"

namespace hqslam::tools {

class RunOutput;

/// One processed scan.
struct ScanRecord {
  std::int64_t scan = 0;  ///< of the recording, counted from 0; those that were left out count
  slam::ScanReport report;
  double reading_s = 0.0;     ///< reading and projecting the file
  double upsampling_s = 0.0;  ///< filling the missing rows and making points of them
  std::int64_t invalid_points = 0;
  /// Of a sensor that sends now: from the packet that completed the scan to its pose.
  std::optional<double> latency_s;
};

/// Why a run came to its end.
enum class RunEnd { kComplete, kInterrupted, kUnreadableScan };

/// A run of SLAM over a recording, finished or not.
struct SlamRun {
  std::string command = "run";  ///< the subcommand that made it
  std::string input;
  std::string sensor_name;
  int rows = 0;
  int columns = 0;
  std::string upsampled_by;  ///< nn::Upsampler::name(); empty: the recording as it is
  slam::SlamOptions slam;
  slam::MountingOptions mounting;  ///< slam::Slam::mounting()
  int threads = 1;
  /// Or that have come from a sensor; nothing as long as only the end of the recording tells.
  std::optional<std::int64_t> scans_in_recording;
  std::vector<ScanRecord> scans;
  std::vector<slam::LoopReport> loops;       ///< places that were recognised, and are right now
  std::vector<std::size_t> part_of_scan;     ///< slam::Slam::submap_of_scan()
  std::vector<std::size_t> stretch_of_scan;  ///< slam::Slam::segment_of_scan()
  Trajectory trajectory;  ///< T_map_sensor, the map's frame is the first scan's, turned level
  /// Filled when the run ends: of the part of the map with most scans, which that is, and its
  /// points in the map's frame. How others lie to it is not known.
  std::size_t map_part = 0;
  std::vector<Eigen::Vector3f> map_points_m;
  std::string located_in;  ///< the file of the map that it was located in; empty: it made its own
  std::optional<slam::SavedMap> saved_map;  ///< filled when the run ends, if it was asked for
  double wall_s = 0.0;
  RunEnd end = RunEnd::kComplete;
  LeftOut left_out;
  std::string end_message;  ///< the reader's message for kUnreadableScan
};

/// "complete", "interrupted", "unreadable scan"
std::string_view name(RunEnd end);

/// Scans per second over the whole run: reading, upsampling, SLAM and writing.
/// "40 of 80 scans", or "40 scans".
std::string scans_of(const SlamRun& run);

double scans_per_second(const SlamRun& run);

/// One time of every scan, in milliseconds.
struct ScanTimes {
  std::string name;
  std::vector<double> times_ms;
};
ScanTimes scan_times(const SlamRun& run, std::string_view name,
                     const std::function<double(const ScanRecord&)>& seconds);
/// Of the stages in the order in which they run: "reading", "upsampling" if there was any, and
/// SLAM's.
std::vector<ScanTimes> stage_times(const SlamRun& run);
/// Of all of SLAM.
ScanTimes slam_times(const SlamRun& run);

/// How many scans a stage ended with each status: all statuses, kOk first.
std::vector<std::pair<slam::Status, std::int64_t>> status_counts(
    const SlamRun& run, slam::Status slam::ScanReport::*status);

/// How often the path and the map were corrected.
std::int64_t loops_closed(const SlamRun& run);

/// Whether something is known about the way from a scan to the next: both places were recognized,
/// and the sensor was not carried in between, also where its parts of the map were joined later.
bool is_way_known(const SlamRun& run, std::size_t scan);

/// Of which scan of the recording each pose of the trajectory is (ScanRecord::scan).
std::vector<std::int64_t> scan_of_pose(const SlamRun& run);

/// The path as far as it is known, in metres.
double known_path_m(const SlamRun& run);

/// The scans of each part of the map (slam::Slam::submap_of_scan), by its number.
std::map<std::size_t, std::int64_t> scans_of_parts(const SlamRun& run);

/// A map that an earlier run left behind, and where in it the sensor is believed to begin.
struct GivenMap {
  std::string path;
  slam::SavedMap map;
  std::optional<Pose> T_map_level_start;
};

/// How a recording is processed.
struct SlamRunSpec {
  std::string input;
  std::optional<RowSelection> rows;    ///< of the recording that are looked at; nothing: every row
  nn::Upsampler* upsampler = nullptr;  ///< what fills the rows between them; nullptr: nothing
  slam::SlamOptions slam;
  bool save_map = false;  ///< needs loop closing
  std::optional<GivenMap> map;
};

/// The rows of a recorded scan that are looked at.
OrganizedCloud measured_cloud(const OrganizedCloud& cloud, const SlamRunSpec& spec);
/// What SLAM gets to see of them: with the rows between them filled, if there is an upsampler.
OrganizedCloud prepared_cloud(const OrganizedCloud& measured, const SlamRunSpec& spec);

/// SLAM over scans that come one by one, and what is to be told of it.
class SlamSession {
 public:
  /// sensor: of the scans, before anything is made of them.
  SlamSession(const SensorModel& sensor, const SlamRunSpec& spec);

  /// Locates the next scan; hands intermediate results to `output` now and then. `record` says
  /// what is known of it already; `located` is called as soon as its pose is there. A scan that
  /// cannot be understood is counted and left out. Throws Error.
  void process(const RecordedScan& scan, ScanRecord record, RunOutput& output,
               const std::function<void(ScanRecord&)>& located = {});
  /// Everything but how it ended.
  SlamRun& run() { return run_; }
  /// The trajectory and the map as they are now.
  const Trajectory& trajectory() const { return slam_.trajectory(); }
  std::vector<Eigen::Vector3f> map_points_m() const { return slam_.map_points_m(); }
  /// What SLAM saw of the last scan.
  const OrganizedCloud& cloud() const { return cloud_; }
  /// The run with its trajectory and map.
  SlamRun finished();

 private:
  void remember(const slam::LoopReport& loop);

  SlamRunSpec spec_;
  slam::Slam slam_;
  SlamRun run_;
  OrganizedCloud cloud_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Processes a recording scan by scan, showing progress on stderr and handing intermediate results
/// to `output` now and then. A scan that cannot be read ends the run, it does not throw.
SlamRun run_slam(ScanSource& source, const SlamRunSpec& spec, RunOutput& output,
                 const InterruptGuard& interrupt);

}  // namespace hqslam::tools
