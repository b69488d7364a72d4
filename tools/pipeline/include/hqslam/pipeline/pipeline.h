#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "hqslam/core/imu_sample.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/scan.h"
#include "hqslam/core/scan_source.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/pipeline/own_parts.h"
#include "hqslam/pipeline/upsampler.h"
#include "hqslam/slam/options.h"
#include "hqslam/slam/saved_map.h"
#include "hqslam/slam/slam.h"

namespace hqslam::pipeline {

enum class SlamKind {
  kHqslam,    ///< slam::Slam
  kLegoLoam,  ///< LeGO-LOAM as its paper has it: no loop closing, saved map or covariances
};

struct PipelineOptions {
  UpsamplingOptions upsampling = {};
  SlamKind slam = SlamKind::kHqslam;
  slam::SlamOptions slam_options = {};  ///< of kHqslam
  /// A saved map of another drive, in which scans are located; for kHqslam only.
  std::optional<slam::SavedMap> map = {};
  /// The sensor's first pose in that map, turned level; nothing: it is searched in all of the map.
  std::optional<Pose> T_map_level_start = {};
  /// What an earlier pass over the scans found; nothing: they are found on the way.
  std::optional<OwnParts> own_parts = {};
};

/// One scan after upsampling and SLAM.
struct LocatedScan {
  OrganizedCloud cloud;  ///< what SLAM took in: the measured rows, or all rows
  slam::ScanReport report;
  double upsampling_s = 0.0;  ///< with recalling and keeping what a memory holds
};

/// Recorded scans in, poses and a map out:
///
///   recorded scan -> Upsampler (measured rows; OwnParts empty them; DriveMemory, network) -> SLAM
///     -> LocatedScan
///
/// Deterministic, and one object serves one thread at a time, as slam::Slam.
class Pipeline {
 public:
  /// recorded: the sensor of the scans. Throws Error.
  explicit Pipeline(const SensorModel& recorded, const PipelineOptions& options = {});
  /// options.upsampling is not used.
  Pipeline(Upsampler upsampler, const PipelineOptions& options);
  ~Pipeline();
  Pipeline(Pipeline&&) noexcept;  ///< moved from: only assign or destroy
  Pipeline& operator=(Pipeline&&) noexcept;

  const Upsampler& upsampler() const;
  const OwnParts& own_parts() const;
  /// The sensor of LocatedScan::cloud.
  const SensorModel& sensor() const;

  /// What an inertial sensor measured since the last call: slam::Slam::add_imu.
  void add_imu(const std::vector<ImuSample>& samples);
  /// slam::Slam::imu_complaint.
  std::string imu_complaint() const;
  /// A scan of a recording, after its inertial samples. trace: filled by slam::Slam::process; only
  /// of kHqslam. Throws Error; ScanError for a scan to be left out.
  LocatedScan process(const RecordedScan& scan, slam::ScanTrace* trace = nullptr);
  LocatedScan process(const OrganizedCloud& recorded, double stamp_s,
                      slam::ScanTrace* trace = nullptr);
  /// Points as a driver has them.
  LocatedScan process(const Scan& points, slam::ScanTrace* trace = nullptr);

  // What follows is slam::Slam's. LeGO-LOAM closes no loops: everything is in one submap and on one
  // segment.
  std::vector<slam::LoopReport> finish();
  const Trajectory& trajectory() const;
  slam::MountingOptions mounting() const;
  std::vector<std::size_t> submap_of_scan() const;
  const std::vector<std::size_t>& segment_of_scan() const;
  std::vector<std::pair<std::size_t, slam::Covariance>> corrected_covariances() const;
  std::vector<Eigen::Vector3f> map_points_m(std::optional<std::size_t> submap = {},
                                            std::vector<float>* intensity = nullptr) const;
  /// Throws Error for kLegoLoam too.
  slam::SavedMap saved_map() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::pipeline
