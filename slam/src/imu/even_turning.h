#pragma once

#include <Eigen/Core>
#include <vector>

#include "front_end/features.h"
#include "imu/imu_buffer.h"

namespace hqslam::slam {

/// Converts a scan to that of a sensor that turned evenly during the capture.
///
/// All stages correct a scan for a motion of constant velocity, but a hand does not turn evenly.
/// With the gyroscope's rotation R(t) from the stamp to t and the mean rate w over the scan,
///   p'(t) = exp(-w t) R(t) p(t)
/// is the point as measured by a sensor that turned at the constant rate w.
class EvenTurning {
 public:
  /// In: the samples of the whole scan, and the time from its begin to the stamp.
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
