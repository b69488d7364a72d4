#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/pose.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/live/live.h"
#include "live/view_server.h"
#include "pages/turning_view.h"
#include "run/slam_run.h"

namespace hqslam::tools {

/// The points of the page's map: one per voxel, and when they become more than memory and a browser
/// can hold, one per voxel of twice the size.
class LiveMap {
 public:
  static constexpr std::size_t kMostPoints = 60'000;
  static constexpr float kFirstVoxel_m = 0.25F;

  /// A point as a scan measured it, in the sensor's frame; scan: how many scans were added before.
  struct Seen {
    std::size_t scan = 0;
    Eigen::Vector3f point_m = Eigen::Vector3f::Zero();
    float intensity = std::numeric_limits<float>::quiet_NaN();
  };

  /// Points that are not finite or beyond 50 km are left out.
  void add(const Eigen::Vector3f& point_m, const Seen& seen);
  /// Moves the points with the poses of their scans; points of scans beyond them go.
  void move_to(const Trajectory& trajectory);

  const std::vector<Eigen::Vector3f>& points_m() const { return points_m_; }
  std::vector<float> intensity() const;  ///< of each; not a number where it is not known
  float voxel_m() const { return voxel_m_; }

 private:
  bool take_voxel(const Eigen::Vector3f& point_m);
  void coarsen();

  float voxel_m_ = kFirstVoxel_m;
  std::vector<Eigen::Vector3f> points_m_;
  std::vector<Seen> seen_;
  std::unordered_set<std::uint64_t> taken_;
};

/// The state of a run, once a second.
struct LiveStatus {
  double elapsed_s = 0.0;
  std::int64_t scans = 0;            ///< so far
  double rate_hz = 0.0;              ///< scans located in the last second
  std::optional<double> latency_s;   ///< the longest of them
  std::optional<ScanRecord> latest;  ///< the last scan of all
  double path_m = 0.0;
  std::size_t submaps = 1;  ///< SlamSession::submaps()
  live::LiveCounts counts;
  std::string results_failure;  ///< why no results are written now; empty: they are
};

/// A place on the path, and the segment that it is on.
struct PathPosition {
  Eigen::Vector3f place_m = Eigen::Vector3f::Zero();
  std::size_t segment = 0;
};

/// What the page of a sensor that sends now (tools/web/live.html) shows: the path, the map and
/// numbers, all of bounded size. Written by the thread that runs SLAM, read by the page's.
class LiveView {
 public:
  static constexpr std::size_t kMostPositions = 20'000;

  explicit LiveView(std::string title) : title_(std::move(title)) {}

  /// A scan was located. Its points are put where it was at its stamp, not where each was measured.
  /// segment: of the path, slam::Slam::segment_of_scan(); the relative pose of two is unknown.
  void add(const OrganizedCloud& cloud, const Pose& T_map_sensor, std::size_t segment);
  /// A loop was closed: the path and the map moved. trajectory, segment_of_scan: of every scan that
  /// was added, and of any to come.
  void replace(const Trajectory& trajectory, const std::vector<std::size_t>& segment_of_scan);
  void set(const LiveStatus& status);

  /// "/": the page. "/state": the pose and numbers, as JSON. "/view": path, map and last scan
  /// (turning_view_json), a megabyte at most.
  ViewAnswer answer(const std::string& target) const;

 private:
  std::string state() const;
  TurningView turning_view() const;
  void add_position(const PathPosition& position);

  std::string title_;
  mutable std::mutex mutex_;  ///< of what follows
  LiveMap map_;
  std::size_t scans_ = 0;                     ///< that were added
  std::vector<Eigen::Vector3f> last_scan_m_;  ///< in the map's frame
  std::vector<PathPosition> positions_;
  float step_m_ = 0.1F;  ///< between positions
  Pose T_map_sensor_ = Pose::Identity();
  std::size_t segment_ = 0;
  LiveStatus status_;
};

}  // namespace hqslam::tools
