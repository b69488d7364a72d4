#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/pose.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::slam {

/// A scan as measured, with its pose by SLAM.
struct LocatedScan {
  /// Not corrected for motion, unless it has no capture times; with all columns or those of
  /// calibration_columns.
  OrganizedCloud cloud;
  Pose T_map_sensor = Pose::Identity();
  Twist velocity;  ///< per second, in the sensor's frame
};

/// Mean distance of a beam's points from the surfaces of all beams, m: above the ground, and in
/// front of walls. Nothing without such points.
struct BeamDistance {
  std::optional<double> ground_m;
  std::optional<double> walls_m;
};

/// The correction to be added to a beam's elevation and range, with standard deviations.
struct BeamCorrection {
  double elevation_rad = 0.0;
  double range_m = 0.0;
  double elevation_sigma_rad = 0.0;
  double range_sigma_m = 0.0;
  BeamDistance before;
  BeamDistance after;
};

struct BeamCalibration {
  std::vector<BeamCorrection> beams;  ///< one per row
  std::int64_t surfaces = 0;
  /// Root mean square distance of all points from their surface, without and with corrections, each
  /// at the poses that fit best.
  double residual_before_m = 0.0;
  double residual_after_m = 0.0;
};

/// Calibrates elevation and range of every beam by surfaces that several beams measure.
///
/// In: scans along a path with their poses by SLAM, about a metre apart; the longer the path the
/// better (50 m suffice). Out: a correction for each beam.
///
/// Model: a point of beam b with range r in direction u(elevation, azimuth), measured at the pose
/// T,
///   p = T (r + dr_b) u(elevation + de_b, azimuth),
/// is on the plane n . p = d of its voxel. de and dr of all beams, the poses and the planes
/// minimise
///   sum over points of w (n . p - d)^2  +  sum over beams of (de / sigma_e)^2 + (dr / sigma_r)^2
/// by Gauss-Newton, with the planes and then the poses eliminated by Schur complements.
/// Stretches of 50 m of path are solved in parallel, with the same beams; their information is
/// averaged, not summed, since their errors are not independent. Source: planes eliminated as in
/// Liu and Zhang, "BALM", RA-L 2021. Differs from it: planes are eliminated linearly, at the
/// voxel's normal; and the beams.
///
/// Unobservable without the prior: a world bent into a bowl, z += c (x^2 + y^2), with beams raised
/// by c times the distance at which they meet the ground and a sensor that pitches by 2 c a metre,
/// gives the same scans; so do a range error that all beams share, if no object is measured from
/// several sides, and the elevation of beams that meet only upright walls.
///
/// Throws Error if a cloud has not the sensor's rows.
BeamCalibration calibrate_beams(const SensorModel& sensor, const std::vector<LocatedScan>& scans);

/// About 128 evenly spread columns of a scan, which are all that a calibration uses: others from
/// scan to scan. They need an eighth of the memory.
OrganizedCloud calibration_columns(const OrganizedCloud& cloud, int scan);

}  // namespace hqslam::slam
