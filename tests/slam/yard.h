#pragma once

#include "hqslam/core/pose.h"
#include "hqslam/core/projection.h"
#include "made_images.h"

namespace hqslam::test {

/// An upright box.
struct Box {
  Eigen::Vector3d low_m, high_m;

  /// How far away a ray from outside enters it; infinite: nowhere.
  double entered_m(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& along) const {
    const Eigen::Array3d a = (low_m - origin_m).array() / along.array();
    const Eigen::Array3d b = (high_m - origin_m).array() / along.array();
    const double enter_m = a.min(b).maxCoeff();
    return enter_m > 0.0 && enter_m < a.max(b).minCoeff() ? enter_m : HUGE_VAL;
  }
};

/// A yard with exact geometry for tests: a floor, four walls and square pillars, scanned from any
/// pose. The frame of the yard has its origin on the floor in the middle, z up.
class Yard {
 public:
  double half_length_m = 30.0;  ///< along x
  double half_width_m = 20.0;   ///< along y
  bool pillars = true;
  double ceiling_m = HUGE_VAL;  ///< above the floor; infinite: none
  bool end_walls = true;        ///< the walls at +-half_length; without them the yard is a corridor

  /// The scan of a sensor that stands still.
  OrganizedCloud scan(const SensorModel& sensor, const Pose& T_yard_sensor) const {
    return unproject(image(sensor, [&](double) { return T_yard_sensor; }), sensor,
                     CaptureTime::kMotionCorrected);
  }

  /// The scan of a sensor that moves: T_yard_sensor_at(time after the stamp, seconds).
  OrganizedCloud rolling_scan(const SensorModel& sensor, const auto& T_yard_sensor_at) const {
    return unproject(image(sensor, T_yard_sensor_at), sensor, CaptureTime::kRolling);
  }

 private:
  RangeImage image(const SensorModel& sensor, const auto& T_yard_sensor_at) const {
    return made_image(sensor, [&](int row, int column, const Eigen::Vector3d& direction) {
      const double turned = (sensor.firing_column(row, column) + 0.5) / sensor.columns;
      const Pose T_yard_beam = T_yard_sensor_at((turned - 0.5) * sensor.scan_period_s);
      const double range_m = cast(T_yard_beam.translation(), T_yard_beam.linear() * direction);
      return range_m < sensor.max_range_m ? range_m : 0.0;
    });
  }

  double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    const double flat_m = direction.z() < 0.0 ? 0.0 : ceiling_m;
    double nearest = (flat_m - origin.z()) / direction.z();
    const double half[2] = {half_length_m, half_width_m};
    for (int axis = end_walls ? 0 : 1; axis < 2; ++axis) {
      const double wall = direction[axis] > 0.0 ? half[axis] : -half[axis];
      const double distance = (wall - origin[axis]) / direction[axis];
      const double height = origin.z() + distance * direction.z();
      if (distance > 0.0 && distance < nearest && height < 6.0) nearest = distance;
    }
    if (!pillars) return nearest;
    for (int i = -3; i <= 3; ++i) {
      for (const double side : {-1.0, 1.0}) {
        const Eigen::Vector3d centre(8.0 * i + side, side * (9.0 + 0.7 * i), 0.0);
        const Eigen::Vector3d half_m(0.3, 0.3, HUGE_VAL);  // endlessly high
        const Box pillar{centre - half_m, centre + half_m};
        nearest = std::min(nearest, pillar.entered_m(origin, direction));
      }
    }
    return nearest;
  }
};

/// A small sensor: quick to simulate, enough for SLAM.
inline SensorModel small_sensor(int rows = 16, int columns = 512) {
  SensorModel sensor = even_sensor(rows, columns, 10.0, 25.0 / (rows - 1));
  sensor.name = "small";
  return sensor;
}

inline Pose yard_pose(double x_m, double y_m, double yaw_rad) {
  return pose_from_xyz_rpy({x_m, y_m, 1.7}, 0.0, 0.0, yaw_rad);
}

}  // namespace hqslam::test
