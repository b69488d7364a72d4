#include "map/choice_of_start.h"

namespace hqslam::slam {

namespace {

/// A state known better than this is where the scan is looked for, unless the odometry saw it
/// farther away than a search in the map reaches. Otherwise it is looked for where the odometry saw
/// it too, and found there if so many times as much of what stands on the ground fits.
constexpr double kPrecise_m = 0.5;
constexpr double kPrecise_rad = 0.05;
constexpr double kElsewhere_m = 0.3;
constexpr double kElsewhere_rad = 0.03;
constexpr double kFitsBetter = 1.1;

bool is_elsewhere(const Twist& innovation) {
  return innovation.linear.norm() > kElsewhere_m || innovation.angular.norm() > kElsewhere_rad;
}

bool fits_better(const MappingResult& a, const MappingResult& b) {
  if (a.status == Status::kTooFewFeatures) return false;
  if (b.status == Status::kTooFewFeatures) return true;
  return a.inlier_ratio > kFitsBetter * b.inlier_ratio;
}

}  // namespace

bool is_precise(const MotionState& state) {
  const Vector6 variance = state.covariance.diagonal().head<6>();
  return variance.head<3>().maxCoeff() < kPrecise_m * kPrecise_m &&
         variance.tail<3>().maxCoeff() < kPrecise_rad * kPrecise_rad;
}

MappingResult register_from_both(const Mapping& mapping, const MapFeatures& features,
                                 const ExpectedScan& expected) {
  const MotionState& state = expected.state;
  const MappingResult from_expected = mapping.register_scan(features, state, state.T_map_sensor);
  const Twist innovation = logarithm(state.T_map_sensor.inverse() * expected.T_map_moved);
  if (is_precise(state) && !is_elsewhere(innovation)) return from_expected;
  const MappingResult from_odometry = mapping.register_scan(
      features, with_innovation(state, innovation, expected.duration_s), expected.T_map_moved);
  return fits_better(from_odometry, from_expected) ? from_odometry : from_expected;
}

}  // namespace hqslam::slam
