#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "hqslam/core/pose.h"
#include "hqslam/slam/beam_calibration.h"

namespace hqslam::slam {

/// A measured point in its scan's frame at the stamp, as a function of its beam's correction:
///   p = (range_m + dr) (direction + de * tilt) + offset_m.
struct CalibrationRay {
  int beam = 0;
  int scan = 0;  ///< of the stretch
  double range_m = 0.0;
  Eigen::Vector3d direction;
  Eigen::Vector3d tilt;      ///< derivative of the direction by the elevation
  Eigen::Vector3d offset_m;  ///< the sensor's translation from the stamp to the capture time
};

/// Scans of a stretch of path, which are solved together.
struct CalibrationStretch {
  std::vector<CalibrationRay> rays;
  std::vector<Pose> T_map_sensor;
};

/// Of the calibration_columns of each scan.
CalibrationStretch calibration_stretch(std::span<const LocatedScan> scans);

/// Elevation (even) and range (odd) of the beams.
using BeamParameters = Eigen::VectorXd;

/// A quadratic model of the cost, planes eliminated: g^T x + x^T H x / 2, with x the change of the
/// beams, then of the poses (translation, rotation; axes of the map); and the residuals.
struct CalibrationSystem {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  std::int64_t surfaces = 0;
  double weight = 0.0;
  double weighted_squares_m2 = 0.0;
  /// Per beam: sum and count of distances from the ground, then from walls.
  Eigen::ArrayX4d distances;
};
CalibrationSystem linearized(const CalibrationStretch& stretch, const BeamParameters& beams);

/// Moves the poses of a stretch to the system's solution for a change of the beams.
void move_poses(CalibrationStretch& stretch, const CalibrationSystem& system,
                const Eigen::VectorXd& beam_change);

/// The information of a stretch about the beams alone, poses eliminated.
struct BeamInformation {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
};
BeamInformation beam_information(const CalibrationSystem& system, Eigen::Index beam_parameters);

}  // namespace hqslam::slam
