#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hqslam/core/organized_cloud.h"
#include "hqslam/core/pose.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::slam {

/// A scan as it was measured, and where SLAM found it.
struct LocatedScan {
  OrganizedCloud cloud;  ///< not corrected for motion, unless it has no capture times
  Pose T_map_sensor = Pose::Identity();
  Twist velocity;  ///< per second, in the sensor's frame
};

/// How far a beam's points lie from the surfaces that all beams see, in the mean, m: above the
/// ground, and this side of walls. Nothing where it met none.
struct BeamDistance {
  std::optional<double> ground_m;
  std::optional<double> walls_m;
};

/// What is to be added to what one beam says, and how well that is known (standard deviations).
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
  double residual_before_m = 0.0;  ///< root mean square distance of all points from their surface
  double residual_after_m = 0.0;
};

/// Elevation and range of every beam, from what all beams say of the same surfaces.
///
/// In: scans along a path that SLAM followed, with the poses that it found, a metre or so apart;
/// the longer the path the better (50 m do). Out: a correction for each beam.
///
/// Model: a point of beam b with range r in direction u(elevation, azimuth), measured at the pose
/// T,
///   p = T (r + dr_b) u(elevation + de_b, azimuth),
/// lies on the plane n . p = d of its voxel. Sought are de and dr of all beams, the poses and the
/// planes that make
///   sum over points of w (n . p - d)^2  +  sum over beams of (de / sigma_e)^2 + (dr / sigma_r)^2
/// least: Gauss-Newton, with the planes and then the poses eliminated by Schur complements.
/// Stretches of 50 m of path are solved beside each other, with the same beams; what they say is
/// averaged, not summed: their errors are not independent. Source: planes eliminated as in Liu and
/// Zhang, "BALM", RA-L 2021. Differs from it: planes are eliminated linearly, at the voxel's
/// normal; and the beams.
///
/// What cannot be told apart. If the world were bent into a bowl, z += c (x^2 + y^2), and the beams
/// raised by c times the distance at which they meet the ground, every scan would look the same,
/// and the sensor would pitch by 2 c a metre. Only the prior speaks against it. So does it against
/// a range error that all beams share, where nothing is seen from several sides, and about the
/// elevation of beams that meet nothing but upright walls.
///
/// Throws Error if a cloud is not of the sensor's shape.
BeamCalibration calibrate_beams(const SensorModel& sensor, const std::vector<LocatedScan>& scans);

}  // namespace hqslam::slam
