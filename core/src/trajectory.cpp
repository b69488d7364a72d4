#include "hqslam/core/trajectory.h"

namespace hqslam {

Trajectory relative_to_first(const Trajectory& trajectory) {
  Trajectory result = trajectory;
  if (result.empty()) return result;
  const Pose T_first_map = trajectory.front().T_map_sensor.inverse();
  for (StampedPose& pose : result) pose.T_map_sensor = T_first_map * pose.T_map_sensor;
  result.front().T_map_sensor = Pose::Identity();
  return result;
}

double path_length_m(const Trajectory& trajectory) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length_m +=
        (trajectory[i].T_map_sensor.translation() - trajectory[i - 1].T_map_sensor.translation())
            .norm();
  }
  return length_m;
}

}  // namespace hqslam
