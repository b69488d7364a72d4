#pragma once

#include <Eigen/Core>
#include <vector>

#include "front_end/features.h"
#include "imu/imu_buffer.h"

namespace hqslam::slam {

/// Makes a scan as if the sensor had turned evenly while it was captured.
///
/// All stages correct a scan for a motion of constant velocity. A hand does not turn evenly; but
/// with the gyroscope's turn R(t) from the stamp to t and the mean rate w over the scan,
///   p'(t) = exp(-w t) R(t) p(t)
/// is where a sensor would have seen the point that turned at w all the while.
class EvenTurning {
 public:
  /// In: what was measured over the whole scan, and how long before the stamp that begins.
  EvenTurning(const std::vector<ImuStep>& scan, double before_stamp_s,
              const Eigen::Vector3d& gyroscope_bias_rad_per_s);

  const Eigen::Vector3d& mean_rate_rad_per_s() const { return mean_rate_rad_per_s_; }
  void apply(Features& features) const;

 private:
  void apply(std::vector<FeaturePoint>& points) const;

  Eigen::Vector3d mean_rate_rad_per_s_;
  double begin_s_;  ///< of the scan, after its stamp
  double duration_s_;
  std::vector<Eigen::Vector3f> turn_rad_;  ///< logarithm of exp(-w t) R(t), at even distances
};

}  // namespace hqslam::slam
