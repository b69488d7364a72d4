#include "hqslam/core/trajectory.h"

namespace hqslam {

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
