#pragma once

#include <Eigen/Core>
#include <vector>

#include "front_end/features.h"
#include "hqslam/core/pose.h"

namespace hqslam::slam {

/// Moves points to where they would have been measured at the scan's stamp.
///
/// In: a point p(t) in the sensor frame at its own time t (offset from the stamp), the sensor's
/// velocity per second. Out:
///   p(0) = T_stamp_sensor(t) p(t),  T_stamp_sensor(t) = exponential(t velocity).
/// Source: LOAM, section V A (constant velocity within a sweep).
/// Differs from LeGO-LOAM: no IMU; along a screw, not along a chord; corrected to the stamp, not to
/// the end of the sweep; points without offset (a motion-corrected scan) are left unchanged. In
/// single precision.
class MotionCorrection {
 public:
  explicit MotionCorrection(const Twist& velocity);
  Eigen::Vector3f operator()(const FeaturePoint& point) const;

 private:
  /// A smaller rotation moves no point by a micrometre.
  static constexpr float kNoTurn_rad = 1e-8F;

  float angle_rad_;
  Eigen::Vector3f linear_m_;
  Eigen::Vector3f axis_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f across_m_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f twice_across_m_ = Eigen::Vector3f::Zero();
};

/// MotionCorrection of all points.
std::vector<Eigen::Vector3f> motion_corrected(const std::vector<FeaturePoint>& points,
                                              const Twist& velocity);

}  // namespace hqslam::slam
