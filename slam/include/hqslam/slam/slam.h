#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
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

/// What happened to one scan.
struct ScanReport {
  double stamp_s = 0.0;
  Pose T_odom_sensor = Pose::Identity();  ///< odometry alone: smooth, drifts
  Pose T_map_sensor = Pose::Identity();   ///< after scan-to-map optimisation and loop closing
  /// Of T_map_sensor against the truth, the first scan's pose being exact: the covariance of e in
  /// T_true = T_map_sensor exp(e), (linear, angular) in the sensor's frame, m^2, m rad, rad^2.
  /// What is in it, and what it was calibrated on: src/alignment/drift.h. Zero up to the first scan
  /// of the map. What was not measured while the way was lost stays in it until a loop takes it
  /// away. Infinite variances where the place was not recognized, and after the sensor was carried
  /// away.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// How the sensor moves, per second in its frame, and the covariance of the error, (linear,
  /// angular); of a scan that nothing was matched with that of whatever moves on earth. It takes
  /// errors of features as independent, so it is too small, as a rule, and not calibrated.
  Twist velocity;
  Eigen::Matrix<double, 6, 6> velocity_covariance = Eigen::Matrix<double, 6, 6>::Zero();
  Status odometry_status = Status::kOk;
  Status mapping_status = Status::kOk;
  int returns = 0;
  int ground_points = 0;
  int clusters = 0;
  int edge_features = 0;
  int planar_features = 0;
  int edge_correspondences = 0;  ///< used by the last iteration of mapping
  int planar_correspondences = 0;
  bool keyframe = false;
  /// An inertial sensor measured all of the way since the scan before.
  bool predicted_by_imu = false;
  LoopReport loop;
  StageTimes times;
};

/// LeGO-LOAM without ROS: scan in, pose out.
///
///   OrganizedCloud -> ground, clusters -> edge and planar features -> two-step odometry
///   -> de-skewed features -> scan-to-map optimisation -> loop closing -> pose, map
///
/// Deterministic: the same scans give the same bytes, whatever the number of threads. Every scan
/// is processed in the call that brings it; loop closing works beside the calls, in a thread of its
/// own, and what it finds out is taken in ten scans later.
///
/// A sensor that was carried away or blinded for long goes on in a submap of its own, as if it
/// stood where it was believed to be. Loop closing joins the submaps when it recognizes a place.
///
/// Threads: one object serves one thread at a time, reading included; objects are independent of
/// one another. process() works with options.threads OpenMP threads, or, inside a parallel region
/// of the caller's, with the one that calls it. A driver's callback may call it directly; whoever
/// cannot wait for a scan's time hands scans over to a thread of their own.
class Slam {
 public:
  /// Throws Error if the sensor or an option is invalid.
  explicit Slam(const SensorModel& sensor);
  Slam(const SensorModel& sensor, const SlamOptions& options);
  /// Registers scans in a map that another drive left behind (saved_map()), which stays as it is.
  /// The first scan is looked for about T_map_level_start (where the sensor stands, turned level),
  /// within a few metres and half a radian, or in all of the map; so is the next one where it is
  /// not found, and wherever the way is lost: then the mapping's status is kNotRecognized. Poses
  /// are in the map's frame, and their covariances against it; loops are not closed. Throws Error,
  /// also if there is no place in the map.
  Slam(const SensorModel& sensor, const SlamOptions& options, const SavedMap& map,
       const std::optional<Pose>& T_map_level_start = std::nullopt);
  ~Slam();
  Slam(Slam&&) noexcept;  ///< moved from: only assign or destroy
  Slam& operator=(Slam&&) noexcept;

  /// What an inertial sensor measured since the last call, before the scan that it belongs to: up
  /// to that scan's end. Scans are then corrected for an uneven turn, and looked for where the
  /// samples say; biases are estimated. Nothing is said of the samples: what cannot be used is left
  /// out, and a scan that they do not cover is as without.
  void add_imu(const std::vector<ImuSample>& samples);

  /// Throws Error if the cloud's shape is not the sensor's, if a pixel has no point, range, capture
  /// time or intensity of its own (but none need have a time or an intensity), or if the stamp is
  /// no time in seconds; ScanError if the capture times are no offsets from the middle of the scan
  /// in seconds. Whatever the numbers inside the cloud are is survived: a pixel with one that is
  /// not finite is no return. Stamps need not rise: see src/front_end/scan_clock.h. Where a trace
  /// is given it is filled with what each stage made of the scan; nothing is spent on it otherwise.
  ScanReport process(const OrganizedCloud& cloud, double stamp_s, ScanTrace* trace = nullptr);

  /// After the last scan: takes in what loop closing was still finding out, and reports it.
  std::vector<LoopReport> finish();

  /// T_map_sensor of every scan so far; not to be read while process() runs. The map's frame is
  /// that of the first scan, turned level (mounting()). Where a loop was closed, past poses
  /// are corrected: they differ then from those that were reported.
  const Trajectory& trajectory() const;

  /// How the sensor is mounted, as SlamOptions::mounting says or, where that asks for it and one of
  /// the scans up to the first that SLAM can begin with shows ground, as that does: `estimated`.
  MountingOptions mounting() const;

  /// Per scan the submap it is in; submaps that were joined have one number. Between submaps
  /// nothing is known about how poses lie to each other.
  std::vector<std::size_t> submap_of_scan() const;

  /// Per scan the segment of the trajectory it is on: a new one begins where nothing measured the
  /// way, and stays one of its own when its submap is joined to another. Not to be read while
  /// process() runs.
  const std::vector<std::size_t>& segment_of_scan() const;

  /// Covariances that hold now instead of those that were reported, of the poses of trajectory():
  /// of scans on segments that loop closing joined since, and of the last ones before it was
  /// noticed that the sensor had been carried away (infinite variances). By scan.
  std::vector<std::pair<std::size_t, Eigen::Matrix<double, 6, 6>>> corrected_covariances() const;

  /// The map: planar features of all keyframes, one per 0.4 m voxel, then edge features, one per
  /// 0.2 m voxel (MappingOptions), in the map's frame. Of one submap (its number in
  /// submap_of_scan()), or of all, one after the other, though nothing is known of how they lie to
  /// each other. intensity: takes one per point, the mean of those of its features in the unit of
  /// the recording, not a number where none is known; empty if none is.
  std::vector<Eigen::Vector3f> map_points_m(std::optional<std::size_t> submap = {},
                                            std::vector<float>* intensity = nullptr) const;

  /// What later drives are located in: of several submaps the one with most places. Throws Error
  /// unless loop closing is switched on, which keeps the places, and after a drive in a given map.
  SavedMap saved_map() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::slam
