#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "hqslam/core/imu_sample.h"

namespace hqslam::slam {

/// An interval of constant inertial values.
struct ImuStep {
  double duration_s = 0.0;
  Eigen::Vector3d angular_rate_rad_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force_mps2 = Eigen::Vector3d::Zero();
};

/// The mean specific force over steps, at least one.
Eigen::Vector3d mean_specific_force_mps2(const std::vector<ImuStep>& steps);

/// The samples of the last seconds. Each holds from midway after the one before to midway before
/// the next.
class ImuBuffer {
 public:
  /// Samples that are not later than those before them, or that no sensor can have measured, are
  /// left out. If time goes back by ten seconds (a clock was set), the later ones are dropped.
  void add(const std::vector<ImuSample>& samples);

  /// The steps between two times, turned by R_level_sensor. Empty if samples are missing for more
  /// than 50 ms or at an end.
  std::vector<ImuStep> steps(double from_s, double to_s,
                             const Eigen::Matrix3d& R_level_sensor) const;
  void forget_before(double stamp_s);

 private:
  std::deque<ImuSample> samples_;
};

}  // namespace hqslam::slam
