#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "alignment/motion_state.h"
#include "hqslam/core/trajectory.h"
#include "imu/imu_buffer.h"

namespace hqslam::slam {

/// Gravity as a sensor would feel it if it did not accelerate, downwards, in its frame: z, and what
/// a bias b of the accelerometer does to it: z = R^T g - L b.
struct FeltGravity {
  Eigen::Vector3d gravity_mps2;
  Eigen::Matrix3d of_bias;  ///< L
};

/// Of the last of some poses. The gyroscope turns every specific force f into that sensor's frame;
/// integrated twice it is s(t), and with p(t) the position in that frame
///   p(t) - s(t) = p_0 + v_0 t + z t^2 / 2
/// is solved for z by least squares. L is what the same makes of three unit forces. Three seconds
/// tell the vertical to 0.02 to 0.05 degrees, though a map may lean: p is known up to a turn, which
/// v_0 takes.
///
/// steps: from the first pose to the last, the rates without their bias. Nothing where poses and
/// forces do not fit each other.
std::optional<FeltGravity> felt_gravity(const Trajectory& poses, const std::vector<ImuStep>& steps);

/// Keeps the vertical. A scan that is registered in a map of the scans before it leans as they do,
/// and beams that are off add a little with every scan, the same way in the sensor's frame: a
/// degree in a hundred metres. Gravity does not lean.
///
/// A Kalman filter estimates gravity g in the map, the accelerometer's bias b, the lean l of what
/// is registered now (R = exp(l) R_true, map frame) and what one scan adds to it, d (sensor frame):
///   l <- l + R d,   z = R^T (g + l x g) - L b.
/// While the sensor goes straight g and b are known only together; its turns part them, and the
/// lean, which comes slowly, from both. Each found pose is turned about the sensor by -(kShare l +
/// R d), never about the vertical.
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
  using State = Vector12;  ///< g, b, l, d

  void begin(const Eigen::Vector3d& gravity_map_mps2);
  void add_variance(int at, double sigma);
  void add_scan(const Eigen::Matrix3d& R_map_sensor);
  void measure(const Eigen::Matrix3d& R_map_sensor, const FeltGravity& felt);
  Eigen::Vector3d take_turn_rad(const Eigen::Matrix3d& R_map_sensor);

  Trajectory registered_;  ///< the last scans, in a row
  std::optional<State> state_;
  Matrix12 covariance_ = Matrix12::Zero();
};

}  // namespace hqslam::slam
