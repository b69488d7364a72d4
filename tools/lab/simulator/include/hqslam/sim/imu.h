#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "hqslam/core/imu_sample.h"
#include "hqslam/core/pose.h"

namespace hqslam::sim {

/// A sample of an inertial sensor in the LiDAR's frame.
struct SimulatedImuSample : ImuSample {
  // The biases in the sample, which are part of the truth.
  Eigen::Vector3d gyroscope_bias_rad_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d accelerometer_bias_mps2 = Eigen::Vector3d::Zero();
};

constexpr double kImuPeriod_s = 0.01;

using Motion = std::function<Pose(double time_s)>;

/// Without noise and bias, the mean over the period T around `stamp_s` as such sensors give it:
///   w = log(R(t - T/2)^T R(t + T/2)) / T,  f = R(t)^T ((v(t + T/2) - v(t - T/2)) / T + g e_z)
/// with v by central differences of the position over 2 ms. World z is up.
SimulatedImuSample exact_imu_sample(const Motion& T_world_sensor, double stamp_s);

/// The samples of a drive one after the other, with errors of the sizes of the ICM-20948 that an
/// OS1 has: white noise of density n (standard deviation n / sqrt T of a sample) and a bias that
/// walks with density b (b sqrt T from one sample to the next).
///                                 noise              bias at first   bias's walk
///   gyroscope       (rad/s)       0.015 deg/s/rtHz   0.5 deg/s       1.9e-5 rad/s^2/rtHz
///   accelerometer   (m/s^2)       230 ug/rtHz        10 mg           3.0e-3 m/s^3/rtHz
/// Sources: noise, the sensor's data sheet DS-000189, which also bounds the first bias (5 deg/s, 50
/// mg; most sensors are better); the walk, which it does not give, as of the sensor in Burri et
/// al., "The EuRoC micro aerial vehicle datasets", IJRR 2016.
class SimulatedImu {
 public:
  explicit SimulatedImu(std::uint64_t drive_seed);
  SimulatedImuSample next(const Motion& T_world_sensor);
  double next_stamp_s() const { return static_cast<double>(samples_) * kImuPeriod_s; }

 private:
  std::uint64_t seed_;
  std::int64_t samples_ = 0;
  Eigen::Vector3d gyroscope_bias_rad_per_s_;
  Eigen::Vector3d accelerometer_bias_mps2_;
};

}  // namespace hqslam::sim
