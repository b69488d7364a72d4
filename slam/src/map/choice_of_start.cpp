#include "map/choice_of_start.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "hqslam/core/angles.h"

namespace hqslam::slam {

namespace {

using FitComparison = bool (*)(const MappingResult&, const MappingResult&);

/// A state known better than this is the only start of a scan that fits.
constexpr double kPrecise_m = 0.5;
constexpr double kPrecise_rad = 0.05;
/// Turns of a hand in half a second (a real OS0); a search converges from about 10 degrees.
constexpr std::array<double, 6> kTurns_rad = {15.0 * kDegree_rad, -15.0 * kDegree_rad,
                                              30.0 * kDegree_rad, -30.0 * kDegree_rad,
                                              45.0 * kDegree_rad, -45.0 * kDegree_rad};

/// Along the sensor's axes, of a vehicle whose velocity is unknown: a search converges from about a
/// metre. Chosen on simulated starts, checked on real ones (HDL-64E, VLP-16).
constexpr std::array<double, 4> kSpeeds_mps = {10.0, -10.0, 20.0, -20.0};

/// Whether a search ended at another place, at which the scan does not fit clearly less well.
bool fits_as_well_elsewhere(const MappingResult& other, const MappingResult& best) {
  // Chosen on the real handheld OS0 with few scans.
  constexpr double kElsewhere_m = 0.3;
  constexpr double kElsewhere_rad = 0.1;
  const Pose apart = best.state.T_map_sensor.inverse() * other.state.T_map_sensor;
  return other.status != Status::kTooFewFeatures && !fits_better_than_chance(best, other) &&
         (apart.translation().norm() > kElsewhere_m || rotation_angle_rad(apart) > kElsewhere_rad);
}

/// A scan that fits badly, or did not converge, may have turned as no vehicle does.
bool fits_badly(const MappingResult& found, double last_close_ratio) {
  return found.status == Status::kTooFewFeatures || found.status == Status::kNotConverged ||
         found.close_ratio < kDoubtfulFit * last_close_ratio;
}

Pose turned(const Pose& T_map_sensor, double turn_rad) {
  Pose result = T_map_sensor;
  result.prerotate(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()));
  result.translation() = T_map_sensor.translation();
  return result;
}

Pose displaced(const Pose& T_map_sensor, int axis, double by_m) {
  Pose result = T_map_sensor;
  result.translation() += by_m * result.linear().col(axis);
  return result;
}

/// The pose whose vertical axis is that of the map, turned about it as before.
Pose upright(Pose T_map_sensor) {
  const Eigen::Vector3d vertical = T_map_sensor.linear().col(2);
  T_map_sensor.linear() =
      Eigen::Quaterniond::FromTwoVectors(vertical, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
      T_map_sensor.linear();
  return T_map_sensor;
}

}  // namespace

bool fits_better(const MappingResult& a, const MappingResult& b) {
  if (a.status == Status::kTooFewFeatures) return false;
  if (b.status == Status::kTooFewFeatures) return true;
  return a.close_ratio > kClearlyBetter * b.close_ratio;
}

bool fits_better_than_chance(const MappingResult& a, const MappingResult& b) {
  constexpr double kByChance = 3.0;
  return fits_better(a, b) &&
         (b.status == Status::kTooFewFeatures ||
          a.close_planes > b.close_planes + kByChance * std::sqrt(b.close_planes));
}

bool is_precise(const MotionState& state) {
  const Vector6 variance = state.covariance.diagonal().head<6>();
  return variance.head<3>().maxCoeff() < kPrecise_m * kPrecise_m &&
         variance.tail<3>().maxCoeff() < kPrecise_rad * kPrecise_rad;
}

MappingResult register_from_starts(const Mapping& mapping, const MapFeatures& features,
                                   const ExpectedScan& expected) {
  const MotionState& state = expected.state;
  MappingResult best = mapping.register_scan(features, state, expected.T_map_start);
  std::vector<MappingResult> found = {best};
  const auto begin_at = [&](const Pose& T_map_start,
                            FitComparison is_better = fits_better_than_chance) {
    const Twist innovation = logarithm(state.T_map_sensor.inverse() * T_map_start);
    found.push_back(mapping.register_scan(
        features, with_innovation(state, innovation, expected.duration_s), T_map_start));
    if (is_better(found.back(), best)) best = found.back();
  };
  if (!is_precise(state) || fits_badly(best, expected.last_close_ratio)) {
    Pose T_map_moved = expected.T_map_moved();
    if (expected.is_turn_measured) T_map_moved.linear() = state.T_map_sensor.linear();
    begin_at(T_map_moved);
  }
  if (expected.is_speed_unknown) {
    for (const double speed_mps : kSpeeds_mps) {
      for (const int axis : {0, 1}) {
        begin_at(displaced(expected.T_map_last, axis, speed_mps * expected.duration_s));
      }
    }
  }
  // On stairs both fits have few planes: beyond chance the upright pose would seldom be better.
  if (!best.has_ground) begin_at(upright(state.T_map_sensor), fits_better);
  // If nothing fits, a sample of the inertial sensor may be wrong.
  const bool is_heading_known = expected.is_turn_measured && best.status != Status::kTooFewFeatures;
  if (!is_heading_known && fits_badly(best, expected.last_close_ratio)) {
    for (const double turn_rad : kTurns_rad) begin_at(turned(state.T_map_sensor, turn_rad));
  }
  if (!is_heading_known && fits_badly(best, expected.last_close_ratio)) {
    begin_at(expected.T_map_last);
    for (const double turn_rad : kTurns_rad) begin_at(turned(expected.T_map_last, turn_rad));
  }
  best.is_ambiguous = std::ranges::any_of(
      found, [&](const MappingResult& other) { return fits_as_well_elsewhere(other, best); });
  return best;
}

}  // namespace hqslam::slam
