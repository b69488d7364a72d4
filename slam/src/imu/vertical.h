#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "hqslam/core/trajectory.h"
#include "imu/imu_buffer.h"

namespace hqslam::slam {

/// Keeps the vertical. A scan that is registered in a map of few scans before it keeps whatever
/// that map leans by, and beams that are off add a little with each scan, always the same way: over
/// a hundred metres a degree. Gravity does not lean.
///
/// The poses of the last three seconds and the forces between them tell gravity as the sensor would
/// feel it now if it did not accelerate. The gyroscope turns every specific force f into the last
/// sensor's frame; integrated twice it is s(t), and with p(t) the position in that frame
///   p(t) - s(t) = p_0 + v_0 t + z t^2 / 2
/// is solved for z by least squares, to 0.02 degrees, though the map may lean: p is known up to a
/// turn, which v_0 takes. A bias b of the accelerometer is in it as L b, L being what the same
/// makes of three unit forces: z = R^T g - L b. Gravity g in the map and b are estimated from all
/// scans (recursive least squares); while the sensor goes straight only their sum is known, and no
/// more is needed. By the turn e that would bring the found pose's vertical to where it is felt,
/// the pose is turned by
///   c = kProportional e + i,   i <- i + kIntegral e,
/// about the sensor, never about the vertical.
class Vertical {
 public:
  /// How long before a scan measurements are asked for.
  static constexpr double kSpan_s = 3.0;

  /// When the first of the last registered scans was; nothing: there is none.
  std::optional<double> begin_s() const;
  /// The found pose, turned so. gravity_map_mps2: about, downwards. steps: since begin_s(), the
  /// rates without their bias.
  Pose upright(const StampedPose& found, const Eigen::Vector3d& gravity_map_mps2,
               const std::vector<ImuStep>& steps);
  /// Scans were missed.
  void interrupt() { registered_.clear(); }
  /// The map was turned.
  void turn(const Eigen::Matrix3d& R_corrected_map);

 private:
  using State = Eigen::Matrix<double, 12, 1>;  ///< g, b, lean (map), lean of one scan (sensor)

  void begin(const Eigen::Vector3d& gravity_map_mps2);

  Trajectory registered_;  ///< the last scans, in a row
  std::optional<State> state_;
  Eigen::Matrix<double, 12, 12> covariance_ = Eigen::Matrix<double, 12, 12>::Zero();
};

}  // namespace hqslam::slam
