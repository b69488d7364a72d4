#include "hqslam/slam/beam_calibration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "calibration/calibration_stretch.h"
#include "front_end/scan_check.h"
#include "hqslam/core/angles.h"

namespace hqslam::slam {

namespace {

constexpr double kStretch_m = 50.0;  // chosen on simulated drives alone
// Chosen on simulated drives and a raw HDL-64E.
constexpr int kIterations = 8;
constexpr int kPoseIterations = 4;

/// Stretches of 50 m of path; the last one takes the remainder.
std::vector<CalibrationStretch> stretches_of(std::span<const LocatedScan> scans) {
  std::vector<double> path_m = {0.0};
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const Pose motion = scans[i - 1].T_map_sensor.inverse() * scans[i].T_map_sensor;
    path_m.push_back(path_m.back() + motion.translation().norm());
  }
  std::vector<std::size_t> begins = {0};
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const bool is_full = path_m[i] - path_m[begins.back()] >= kStretch_m;
    if (is_full && path_m.back() - path_m[i] >= kStretch_m) begins.push_back(i);
  }
  std::vector<CalibrationStretch> result;
  for (std::size_t i = 0; i < begins.size(); ++i) {
    const std::size_t end = i + 1 < begins.size() ? begins[i + 1] : scans.size();
    result.push_back(calibration_stretch(scans.subspan(begins[i], end - begins[i])));
  }
  return result;
}

/// Stretches in parallel, each by one thread: otherwise Eigen would share its products among
/// threads, and their last digits would depend on the number of threads.
template <typename Work>
void for_each_alone(std::size_t stretches, const Work& work) {
#pragma omp parallel for schedule(dynamic)
  for (std::size_t i = 0; i < stretches; ++i) work(i);
}

std::vector<CalibrationSystem> linearized(const std::vector<CalibrationStretch>& stretches,
                                          const BeamParameters& beams) {
  std::vector<CalibrationSystem> systems(stretches.size());
  for_each_alone(stretches.size(),
                 [&](std::size_t i) { systems[i] = linearized(stretches[i], beams); });
  return systems;
}

/// The systems with beams that are not corrected, at poses that fit these: the residuals that
/// remain are the beams', not those of poses that SLAM left millimetres off.
std::vector<CalibrationSystem> without_corrections(std::vector<CalibrationStretch> stretches,
                                                   Eigen::Index beam_parameters) {
  const BeamParameters none = BeamParameters::Zero(beam_parameters);
  std::vector<CalibrationSystem> systems = linearized(stretches, none);
  for (int iteration = 0; iteration < kPoseIterations; ++iteration) {
    for_each_alone(stretches.size(),
                   [&](std::size_t i) { move_poses(stretches[i], systems[i], none); });
    systems = linearized(stretches, none);
  }
  return systems;
}

/// Variances of the beams' errors: at first what makers specify, then estimated from the drive.
struct BeamSpread {
  double elevation_rad2 = 0.05 * 0.05 * kDegree_rad * kDegree_rad;
  double range_m2 = 0.02 * 0.02;

  Eigen::VectorXd information(Eigen::Index beams) const {
    const Eigen::Vector2d of_beam(1.0 / elevation_rad2, 1.0 / range_m2);
    return of_beam.replicate(beams, 1);
  }
  /// The most likely variances given the estimated beams (a step of expectation maximisation), at
  /// least (0.001 degrees)^2 and (0.1 mm)^2.
  void learn(const BeamParameters& beams, const Eigen::MatrixXd& covariance) {
    const Eigen::VectorXd squares = beams.cwiseAbs2() + covariance.diagonal();
    const auto of_kind = [&](Eigen::Index first) {
      return Eigen::VectorXd(squares(Eigen::seq(first, Eigen::last, 2))).mean();
    };
    elevation_rad2 = std::max(of_kind(0), 1e-6 * kDegree_rad * kDegree_rad);
    range_m2 = std::max(of_kind(1), 1e-8);
  }
};

/// The mean over the stretches plus the prior.
BeamInformation mean_information(const std::vector<CalibrationSystem>& systems,
                                 const BeamParameters& beams, const Eigen::VectorXd& prior) {
  BeamInformation sum{prior.asDiagonal(), prior.cwiseProduct(beams)};
  std::vector<BeamInformation> of_stretch(systems.size());
  for_each_alone(systems.size(), [&](std::size_t i) {
    of_stretch[i] = beam_information(systems[i], beams.size());
  });
  for (const BeamInformation& one : of_stretch) {
    sum.H += one.H / static_cast<double>(systems.size());
    sum.g += one.g / static_cast<double>(systems.size());
  }
  return sum;
}

double residual_m(const std::vector<CalibrationSystem>& systems) {
  double weight = 0.0;
  double squares = 0.0;
  for (const CalibrationSystem& system : systems) {
    weight += system.weight;
    squares += system.weighted_squares_m2;
  }
  return weight > 0.0 ? std::sqrt(squares / weight) : 0.0;
}

/// without_corrections() from the poses of SLAM or of the corrected beams, whichever fit better:
/// few iterations do not lead away from a bend that no surface shows.
std::vector<CalibrationSystem> best_without_corrections(
    std::vector<CalibrationStretch> by_slam, std::vector<CalibrationStretch> of_corrected_beams,
    Eigen::Index beam_parameters) {
  auto a = without_corrections(std::move(by_slam), beam_parameters);
  auto b = without_corrections(std::move(of_corrected_beams), beam_parameters);
  return residual_m(a) < residual_m(b) ? std::move(a) : std::move(b);
}

std::vector<BeamDistance> distances(const std::vector<CalibrationSystem>& systems) {
  Eigen::ArrayX4d sums = systems.front().distances;
  for (std::size_t i = 1; i < systems.size(); ++i) sums += systems[i].distances;
  // The count sums weights: below 1 all points are far away, on something else.
  const auto mean = [](double sum_m, double count) {
    return count < 1.0 ? std::nullopt : std::optional(sum_m / count);
  };
  std::vector<BeamDistance> result;
  for (Eigen::Index beam = 0; beam < sums.rows(); ++beam) {
    result.push_back({mean(sums(beam, 0), sums(beam, 1)), mean(sums(beam, 2), sums(beam, 3))});
  }
  return result;
}

}  // namespace

BeamCalibration calibrate_beams(const SensorModel& sensor, const std::vector<LocatedScan>& scans) {
  SensorModel shape = sensor;
  for (const LocatedScan& scan : scans) {
    shape.columns = scan.cloud.columns;
    check(scan.cloud, 0.0, shape);
  }
  std::vector<CalibrationStretch> by_slam = stretches_of(scans);
  std::vector<CalibrationStretch> stretches = by_slam;
  BeamSpread spread;
  BeamParameters beams = BeamParameters::Zero(2 * sensor.rows());
  std::vector<CalibrationSystem> systems = linearized(stretches, beams);
  Eigen::MatrixXd covariance;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const BeamInformation known =
        mean_information(systems, beams, spread.information(sensor.rows()));
    covariance = known.H.ldlt().solve(Eigen::MatrixXd::Identity(beams.size(), beams.size()));
    const Eigen::VectorXd change = -covariance * known.g;
    for_each_alone(stretches.size(),
                   [&](std::size_t i) { move_poses(stretches[i], systems[i], change); });
    beams += change;
    spread.learn(beams, covariance);
    systems = linearized(stretches, beams);
  }
  const std::vector<CalibrationSystem> uncorrected =
      best_without_corrections(std::move(by_slam), std::move(stretches), beams.size());
  BeamCalibration result;
  result.residual_before_m = residual_m(uncorrected);
  const std::vector<BeamDistance> before = distances(uncorrected);
  const std::vector<BeamDistance> after = distances(systems);
  for (int row = 0; row < sensor.rows(); ++row) {
    const Eigen::Index at = 2 * row;
    result.beams.push_back({beams[at], beams[at + 1], std::sqrt(covariance(at, at)),
                            std::sqrt(covariance(at + 1, at + 1)),
                            before[static_cast<std::size_t>(row)],
                            after[static_cast<std::size_t>(row)]});
  }
  result.residual_after_m = residual_m(systems);
  for (const CalibrationSystem& system : systems) result.surfaces += system.surfaces;
  return result;
}

}  // namespace hqslam::slam
