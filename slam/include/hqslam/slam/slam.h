#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hqslam/core/imu_sample.h"
#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/core/trajectory.h"
#include "hqslam/slam/loop_report.h"
#include "hqslam/slam/status.h"

namespace hqslam::slam {

struct MountingOptions;
struct SavedMap;
struct ScanTrace;
struct SlamOptions;

/// Seconds spent in each stage of one scan.
struct StageTimes {
  double segmentation_s = 0.0;
  double features_s = 0.0;
  double odometry_s = 0.0;
  double mapping_s = 0.0;
  double loop_closing_s = 0.0;
  double total_s = 0.0;
};

/// 6 x 6, (linear, angular). Not aligned, as Pose.
using Covariance = Eigen::Matrix<double, 6, 6, Eigen::DontAlign>;

/// What happened to one scan.
struct ScanReport {
  double stamp_s = 0.0;
  Pose T_odom_sensor = Pose::Identity();  ///< the motions from scan to scan: smooth, drifts
  Pose T_map_sensor = Pose::Identity();   ///< after scan-to-map optimisation and loop closing
  /// The covariance of T_map_sensor against the truth, the first scan's pose being exact: of e in
  /// T_true = T_map_sensor exp(e), (linear, angular) in the sensor's frame, m^2, m rad, rad^2. Its
  /// terms and their calibration: src/alignment/drift.h. Zero up to the first scan of the map. The
  /// unknown motion after tracking was lost is included until a loop removes it. Infinite variances
  /// where the place was not recognized, and after the sensor was carried away.
  Covariance covariance = Covariance::Zero();
  /// Velocity per second in the sensor's frame, and the covariance of its error, (linear, angular);
  /// for a scan without matches that of an unknown velocity. It takes errors of features as
  /// independent, so it is usually too small, and not calibrated.
  Twist velocity;
  Covariance velocity_covariance = Covariance::Zero();
  Status odometry_status = Status::kOk;  ///< also where the odometry was not needed
  Status mapping_status = Status::kOk;
  int returns = 0;
  int scattered = 0;  ///< returns that were left out: echoes of fog, dust or snow
  int ground_points = 0;
  int edge_features = 0;
  int planar_features = 0;
  int edge_correspondences = 0;  ///< used by the last iteration of mapping
  int planar_correspondences = 0;
  bool keyframe = false;
  /// Inertial data cover all of the time since the scan before.
  bool predicted_by_imu = false;
  LoopReport loop;
  StageTimes times;
};

/// LeGO-LOAM without ROS: scan in, pose out.
///
///   OrganizedCloud -> ground, objects -> edge and planar features -> two-step odometry
///   -> de-skewed features -> scan-to-map optimisation -> loop closing -> pose, map
///
/// Deterministic: the same scans give the same bytes for any number of threads. Every scan is
/// processed in its own call; loop closing works in a thread of its own, and its results are
/// applied ten scans later.
///
/// After a sensor was carried away or blinded for long, tracking continues from the estimated pose
/// in a submap of its own. Loop closing joins the submaps when it recognizes a place.
///
/// Threads: one object serves one thread at a time, reading included; objects are independent of
/// one another. process() uses options.threads OpenMP threads, or, inside a parallel region of the
/// caller's, the calling one. A driver's callback that cannot wait for it needs a thread for SLAM.
class Slam {
 public:
  /// Throws Error if the sensor or an option is invalid.
  explicit Slam(const SensorModel& sensor);
  Slam(const SensorModel& sensor, const SlamOptions& options);
  /// Locates scans in the map of another drive (saved_map()), which does not change. The first scan
  /// is searched within a few metres and half a radian of T_map_level_start (a pose of the level
  /// frame), or in all of the map; so is the next one if it is not found, and later ones after
  /// tracking was lost: meanwhile the mapping's status is kNotRecognized. Poses are in the map's
  /// frame, and their covariances against it; loops are not closed. Throws Error, also if there is
  /// no place in the map.
  Slam(const SensorModel& sensor, const SlamOptions& options, const SavedMap& map,
       const std::optional<Pose>& T_map_level_start = std::nullopt);
  ~Slam();
  Slam(Slam&&) noexcept;  ///< moved from: only assign or destroy
  Slam& operator=(Slam&&) noexcept;

  /// Adds inertial samples, before the scan that they cover up to its end. They predict the scan's
  /// pose and correct it for uneven rotation; biases are estimated. Unusable samples are left out;
  /// scans that are not covered are processed without. A sensor that disagrees with the scans is
  /// left out until it agrees (src/imu/inertial_check.h).
  void add_imu(const std::vector<ImuSample>& samples);
  /// What disagreed and what would agree: "its turns disagree with the scans 57-fold; degrees per
  /// second?"; empty as long as nothing did.
  const std::string& imu_complaint() const;

  /// Throws Error if the cloud's shape is not the sensor's, if a pixel lacks a point, a range or
  /// (if others have them) a capture time, confidence or intensity, or if the stamp is no time in
  /// seconds; ScanError if the capture times are no offsets from the middle of the scan in seconds.
  /// A pixel with a number that is not finite is no return. Stamps need not rise:
  /// src/front_end/scan_clock.h. A trace receives the results of all stages.
  ScanReport process(const OrganizedCloud& cloud, double stamp_s, ScanTrace* trace = nullptr);

  /// After the last scan: applies and returns the remaining results of loop closing.
  std::vector<LoopReport> finish();

  /// T_map_sensor of every scan so far; not to be read while process() runs. The map's frame is
  /// that of the first scan, turned level (mounting()). Loops correct past poses, which then differ
  /// from the reported ones.
  const Trajectory& trajectory() const;

  /// SlamOptions::mounting or, if that is to be estimated or off by more than 5 degrees and a scan
  /// up to the first of the map has ground, the estimate: `estimated`.
  MountingOptions mounting() const;

  /// The submap of each scan; joined submaps have one number. Between submaps relative poses are
  /// unknown.
  std::vector<std::size_t> submap_of_scan() const;

  /// The segment of the trajectory of each scan: a new one begins where the motion is unknown, and
  /// remains when its submap is joined to another. Not to be read while process() runs.
  const std::vector<std::size_t>& segment_of_scan() const;

  /// The covariances of poses of trajectory() that differ from the reported ones, by scan: of scans
  /// on segments that loop closing joined since, and of the last ones before it was noticed that
  /// the sensor had been carried away (infinite variances).
  std::vector<std::pair<std::size_t, Covariance>> corrected_covariances() const;

  /// The map: planar features of all keyframes, one per voxel of
  /// MappingOptions::planar_leaf_m (half of it in rooms), then edge features, one per voxel of
  /// 0.2 m, in the map's frame; of one submap (a number of
  /// submap_of_scan()), or of all, one after the other, although their relative poses are unknown.
  /// intensity: receives one per point, the mean of those of its features in the unit of the
  /// recording, NaN where none is known; empty if none is.
  std::vector<Eigen::Vector3f> map_points_m(std::optional<std::size_t> submap = {},
                                            std::vector<float>* intensity = nullptr) const;

  /// The map in which later drives can be located: of several submaps the one with most places.
  /// Throws Error unless loop closing is switched on, which collects the places, and after a drive
  /// in a given map.
  SavedMap saved_map() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::slam
