#include "hqslam/sim/imu.h"

#include <cmath>

#include "hqslam/core/angles.h"
#include "random.h"

namespace hqslam::sim {

namespace {

/// Standard deviations: of the noise of a sample, of the first bias, of a step of the bias.
struct Sizes {
  double noise;
  double first_bias;
  double bias_step;
};

Sizes sizes_of(double noise_density, double first_bias, double walk_density) {
  const double root_s = std::sqrt(kImuPeriod_s);
  return {noise_density / root_s, first_bias, walk_density * root_s};
}
const Sizes kGyroscope = sizes_of(0.015 * kDegree_rad, 0.5 * kDegree_rad, 1.9e-5);
const Sizes kAccelerometer = sizes_of(230e-6 * kGravity_mps2, 0.01 * kGravity_mps2, 3.0e-3);

Eigen::Vector3d drawn(double sigma, Random& random) {
  Eigen::Vector3d vector;
  for (double& value : vector) value = sigma * random.normal();
  return vector;
}

Eigen::Vector3d velocity_mps(const Motion& T_world_sensor, double time_s) {
  constexpr double kStep_s = 1e-3;
  return (T_world_sensor(time_s + kStep_s).translation() -
          T_world_sensor(time_s - kStep_s).translation()) /
         (2.0 * kStep_s);
}

}  // namespace

SimulatedImuSample exact_imu_sample(const Motion& T_world_sensor, double stamp_s) {
  const double before_s = stamp_s - 0.5 * kImuPeriod_s;
  const double after_s = stamp_s + 0.5 * kImuPeriod_s;
  SimulatedImuSample sample;
  sample.stamp_s = stamp_s;
  sample.angular_rate_rad_per_s =
      logarithm(T_world_sensor(before_s).inverse() * T_world_sensor(after_s)).angular /
      kImuPeriod_s;
  const Eigen::Vector3d acceleration_mps2 =
      (velocity_mps(T_world_sensor, after_s) - velocity_mps(T_world_sensor, before_s)) /
      kImuPeriod_s;
  sample.specific_force_mps2 = T_world_sensor(stamp_s).linear().transpose() *
                               (acceleration_mps2 + kGravity_mps2 * Eigen::Vector3d::UnitZ());
  return sample;
}

SimulatedImu::SimulatedImu(std::uint64_t drive_seed) : seed_(seed_of(drive_seed, DrivePart::kImu)) {
  Random random(seed_);
  gyroscope_bias_rad_per_s_ = drawn(kGyroscope.first_bias, random);
  accelerometer_bias_mps2_ = drawn(kAccelerometer.first_bias, random);
}

SimulatedImuSample SimulatedImu::next(const Motion& T_world_sensor) {
  SimulatedImuSample sample = exact_imu_sample(T_world_sensor, next_stamp_s());
  Random random(seed_of(seed_, static_cast<std::uint64_t>(++samples_)));
  sample.gyroscope_bias_rad_per_s = gyroscope_bias_rad_per_s_;
  sample.accelerometer_bias_mps2 = accelerometer_bias_mps2_;
  sample.angular_rate_rad_per_s += gyroscope_bias_rad_per_s_ + drawn(kGyroscope.noise, random);
  sample.specific_force_mps2 += accelerometer_bias_mps2_ + drawn(kAccelerometer.noise, random);
  gyroscope_bias_rad_per_s_ += drawn(kGyroscope.bias_step, random);
  accelerometer_bias_mps2_ += drawn(kAccelerometer.bias_step, random);
  return sample;
}

}  // namespace hqslam::sim
