#pragma once

#include <Eigen/Core>
#include <vector>

#include "alignment/motion_state.h"
#include "front_end/features.h"

namespace hqslam::slam {

/// Moves points to where they would have been measured at the scan's stamp.
///
/// In: a point p(t) in the sensor frame at its own time t (offset from the stamp), the sensor's
/// velocity v and acceleration a at the stamp. Out:
///   p(0) = T_stamp_sensor(t) p(t),  T_stamp_sensor(t) = exponential(t^2 a / 2) exponential(t v),
/// the first factor to first order: (t^2 / 2) a turns by milliradians.
/// Source: LOAM, section V A (constant velocity within a sweep).
/// Differs from LeGO-LOAM: no IMU, but an acceleration; along a screw, not along a chord; corrected
/// to the stamp, not to the end of the sweep; points without offset (a motion-corrected scan) are
/// left unchanged. In single precision.
class MotionCorrection {
 public:
  explicit MotionCorrection(const ScanMotion& motion);
  Eigen::Vector3f operator()(const FeaturePoint& point) const;

 private:
  Eigen::Vector3f by_velocity(const Eigen::Vector3f& p_m, float time_s) const;

  /// A smaller rotation moves no point by a micrometre.
  static constexpr float kNoTurn_rad = 1e-8F;

  float angle_rad_;
  Eigen::Vector3f linear_m_;
  Eigen::Vector3f axis_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f across_m_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f twice_across_m_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f acceleration_mps2_;
  Eigen::Vector3f angular_acceleration_rad_per_s2_;
};

/// MotionCorrection of all points.
std::vector<Eigen::Vector3f> motion_corrected(const std::vector<FeaturePoint>& points,
                                              const ScanMotion& motion);

}  // namespace hqslam::slam
