#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/sensor_model.h"
#include "hqslam/core/trajectory.h"

namespace hqslam::lego_loam {

/// What feature extraction made of a pixel.
enum class FeatureKind : std::uint8_t {
  kNone,
  kSharp,      ///< edge feature that odometry matches; also a target and in the map
  kLessSharp,  ///< edge feature that is a target of odometry and in the map
  kFlat,       ///< planar feature of the ground that odometry matches; also in the map
  kLessFlat,   ///< planar feature that is, thinned, a target of odometry and in the map
};

/// What the stages made of one scan, to be inspected or compared. Arrays have one value per pixel.
struct ScanTrace {
  static constexpr std::int32_t kNoReturn = -1;
  static constexpr std::int32_t kGround = 0;
  static constexpr std::int32_t kOutlier = -2;  ///< in a cluster that is too small
  std::vector<std::int32_t> label;  ///< one of the above, or the number of a cluster from 1 on
  std::vector<FeatureKind> feature;
  Pose T_start_end = Pose::Identity();  ///< odometry: motion over the sweep
  Pose T_odom_end = Pose::Identity();   ///< odometry, at the end of the sweep
  Pose T_map_end = Pose::Identity();    ///< at the end of the sweep, after mapping
};

/// What happened to one scan. Correspondences are those of the last search, 0 where the stage found
/// too few or did not run; at 10 Hz mapping runs for every fourth scan.
struct ScanReport {
  double stamp_s = 0.0;
  Pose T_odom_sensor = Pose::Identity();  ///< odometry alone, at the stamp
  Pose T_map_sensor = Pose::Identity();   ///< after mapping, at the stamp
  int ground_points = 0;
  int clusters = 0;
  int edge_features = 0;    ///< sharp ones
  int planar_features = 0;  ///< flat ones
  int odometry_edges = 0;   ///< correspondences
  int odometry_planes = 0;  ///< correspondences
  int mapping_edges = 0;    ///< correspondences
  int mapping_planes = 0;   ///< correspondences
  bool keyframe = false;    ///< the scan was added to the map
};

/// LeGO-LOAM as its paper has it, on PCL and Ceres, to be read beside the paper: Shan & Englot,
/// "LeGO-LOAM: Lightweight and Ground-Optimized Lidar Odometry and Mapping on Variable Terrain",
/// IROS 2018. src/ has a file for each section: segmentation (III-B), features (III-C), odometry
/// (III-D), mapping (III-E). Numbers that the paper leaves open are those of the authors' program.
///
/// Serves comparison and teaching: the system in front of which papers on super-resolution put
/// their networks. `slam::Slam` is the one to drive with.
///
/// Differs from LeGO-LOAM: no loop closing (switched off in the authors' program, too) and no
/// inertial sensor; every scan is processed, in one thread, so the same scans give the same poses;
/// rows and columns are the image's; a pose is given for the scan's stamp instead of the end of its
/// sweep. Each stage's header lists what differs in it.
class LegoLoam {
 public:
  /// Throws Error if the sensor is invalid.
  explicit LegoLoam(const SensorModel& sensor);
  ~LegoLoam();
  LegoLoam(LegoLoam&&) noexcept;  ///< moved from: only assign or destroy
  LegoLoam& operator=(LegoLoam&&) noexcept;

  /// Throws Error as slam::Slam::process does: if the cloud's shape is not the sensor's or the
  /// stamp or the capture times are none. A pixel with a number that is not finite is no return.
  /// Where a trace is given it is filled.
  ScanReport process(const OrganizedCloud& cloud, double stamp_s, ScanTrace* trace = nullptr);

  /// T_map_sensor of every scan so far, as it was when the scan was processed. The map's frame is
  /// the sensor's at the end of the first sweep; its pose at the first scan's stamp is estimated
  /// with the second scan.
  const Trajectory& trajectory() const;

  /// The map: planar features of all keyframes, one per 0.4 m voxel, then edge features, one per
  /// 0.2 m voxel, in the map's frame.
  std::vector<Eigen::Vector3f> map_points_m() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hqslam::lego_loam
