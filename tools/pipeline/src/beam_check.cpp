#include "hqslam/pipeline/beam_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hqslam/core/angles.h"

namespace hqslam::pipeline {
namespace {

/// Scans this far apart see enough of each other's surfaces and enough that is new.
constexpr double kStep_m = 1.0;
constexpr double kLargestShareLeft = 0.97;  ///< of the distances from surfaces
constexpr double kMostOfOneSensor_deg = 0.7;

/// Of what the corrections of elevations displace: 0.4 and more with real errors (a raw HDL-64E;
/// simulated vehicles 1 and more), 0.08 to 0.15 in hands that walk.
constexpr double kLeastShareGained = 0.25;

/// How far corrections of elevations displace points 10 m away (RMS over the beams).
double displacement_m(const slam::BeamCalibration& found) {
  constexpr double kRange_m = 10.0;
  double squares = 0.0;
  for (const slam::BeamCorrection& beam : found.beams) {
    squares += beam.elevation_rad * beam.elevation_rad;
  }
  const double count = std::max<double>(1.0, static_cast<double>(found.beams.size()));
  return kRange_m * std::sqrt(squares / count);
}

/// Between the poses before and after.
Twist velocity_at(const Trajectory& trajectory, std::size_t pose) {
  const StampedPose& before = trajectory[pose == 0 ? 0 : pose - 1];
  const StampedPose& after = trajectory[std::min(pose + 1, trajectory.size() - 1)];
  const double duration_s = after.stamp_s - before.stamp_s;
  if (!(duration_s > 0.0)) return {};
  return (1.0 / duration_s) * logarithm(before.T_map_sensor.inverse() * after.T_map_sensor);
}

}  // namespace

void BeamCheck::add(const OrganizedCloud& recorded, const slam::ScanReport& report,
                    const Pipeline& pipeline) {
  if (is_complete()) return;
  is_lost_ = pipeline.segment_of_scan().back() > 0;
  const bool is_in_fog = report.scattered > 0;  // a short view does not tell beams from the path
  if (is_lost_ || is_in_fog || !slam::is_registered(report.mapping_status)) return;
  const Eigen::Vector3d position_m = report.T_map_sensor.translation();
  if (last_m_) path_m_ += (position_m - *last_m_).norm();
  last_m_ = position_m;
  if (last_kept_m_ && (position_m - *last_kept_m_).norm() < kStep_m) return;
  clouds_.push_back(slam::calibration_columns(pipeline.upsampler().measured(recorded),
                                              static_cast<int>(clouds_.size())));
  pose_of_cloud_.push_back(pipeline.trajectory().size() - 1);
  last_kept_m_ = position_m;
}

std::vector<slam::LocatedScan> BeamCheck::scans(const Trajectory& trajectory) const {
  std::vector<slam::LocatedScan> result;
  for (std::size_t i = 0; i < clouds_.size(); ++i) {
    const std::size_t pose = pose_of_cloud_[i];
    result.push_back({clouds_[i], trajectory[pose].T_map_sensor, velocity_at(trajectory, pose)});
  }
  return result;
}

bool has_errors(const slam::BeamCalibration& found) {
  if (found.residual_after_m > kLargestShareLeft * found.residual_before_m) return false;
  const double gained_m = std::sqrt(found.residual_before_m * found.residual_before_m -
                                    found.residual_after_m * found.residual_after_m);
  return gained_m >= kLeastShareGained * displacement_m(found);
}

SensorModel corrected(SensorModel sensor, const std::optional<RowSelection>& rows,
                      const slam::BeamCalibration& found) {
  const auto count = static_cast<std::size_t>(sensor.rows());
  sensor.elevation_correction_rad.resize(count, 0.0);
  sensor.range_correction_m.resize(count, 0.0);
  const RowSelection used = rows.value_or(RowSelection{});
  for (int row = 0; row < sensor.rows(); ++row) {
    const auto beam = std::lround(static_cast<double>(row - used.offset) / used.stride);
    const slam::BeamCorrection& correction = found.beams[static_cast<std::size_t>(
        std::clamp(beam, 0L, static_cast<long>(found.beams.size()) - 1))];
    sensor.elevation_correction_rad[static_cast<std::size_t>(row)] += correction.elevation_rad;
    sensor.range_correction_m[static_cast<std::size_t>(row)] += correction.range_m;
  }
  return sensor;
}

std::string complaint_about(const SensorModel& corrected) {
  double largest_deg = 0.0;
  for (const double correction_rad : corrected.elevation_correction_rad) {
    largest_deg = std::max(largest_deg, kDegreesPerRadian * std::abs(correction_rad));
  }
  if (largest_deg <= kMostOfOneSensor_deg) return "";
  return fmt::format(
      "the corrections of elevations reach {:.2f} degrees, those of one sensor {} at most: is '{}' "
      "the right one?",
      largest_deg, kMostOfOneSensor_deg, corrected.name);
}

}  // namespace hqslam::pipeline
