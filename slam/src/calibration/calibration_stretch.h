#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "hqslam/core/pose.h"
#include "hqslam/slam/beam_calibration.h"

namespace hqslam::slam {

/// A measured point in its scan's frame at the stamp, as far as corrections move it:
///   p = (range_m + dr) (direction + de * tilt) + offset_m.
struct CalibrationRay {
  int beam = 0;
  int scan = 0;  ///< of the stretch
  double range_m = 0.0;
  Eigen::Vector3d direction;
  Eigen::Vector3d tilt;      ///< what the direction changes by with the elevation, per radian
  Eigen::Vector3d offset_m;  ///< what the sensor moved by up to the stamp
};

/// Scans that are solved together.
struct CalibrationStretch {
  std::vector<CalibrationRay> rays;
  std::vector<Pose> T_map_sensor;
};

/// Every few columns of each scan, other ones from scan to scan.
CalibrationStretch calibration_stretch(std::span<const LocatedScan> scans);

/// Elevation (even) and range (odd) of the beams.
using BeamParameters = Eigen::VectorXd;

/// A quadratic model of the cost, planes eliminated: g^T x + x^T H x / 2, x the change of beams,
/// then of poses (translation, rotation; in the map's axes), and what the rays lie off.
struct CalibrationSystem {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  std::int64_t surfaces = 0;
  double weight = 0.0;
  double weighted_squares_m2 = 0.0;
  /// Per beam, sums and counts of distances from ground and walls.
  Eigen::ArrayX4d distances;
};
CalibrationSystem linearized(const CalibrationStretch& stretch, const BeamParameters& beams);

/// Moves the poses of a stretch as the system says once the beams have changed.
void move_poses(CalibrationStretch& stretch, const CalibrationSystem& system,
                const Eigen::VectorXd& beam_change);

/// What a stretch says about the beams alone, poses eliminated.
struct BeamInformation {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
};
BeamInformation beam_information(const CalibrationSystem& system, Eigen::Index beam_parameters);

}  // namespace hqslam::slam
