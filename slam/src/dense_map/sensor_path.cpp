#include "hqslam/slam/sensor_path.h"

#include "hqslam/core/error.h"

namespace hqslam::slam {

SensorPath::SensorPath(const Trajectory& trajectory, std::size_t scan) {
  if (scan >= trajectory.size()) {
    throw Error("expected a pose of scan {}, found a trajectory of {}; give one for each scan",
                scan, trajectory.size());
  }
  const StampedPose& here = trajectory[scan];
  T_map_sensor_ = here.T_map_sensor;
  const auto neighbour = [&](const StampedPose& other) {
    return Neighbour{here.T_map_sensor.inverse() * other.T_map_sensor,
                     other.stamp_s - here.stamp_s};
  };
  if (scan > 0 && trajectory[scan - 1].stamp_s < here.stamp_s) {
    before_ = neighbour(trajectory[scan - 1]);
  }
  if (scan + 1 < trajectory.size() && trajectory[scan + 1].stamp_s > here.stamp_s) {
    after_ = neighbour(trajectory[scan + 1]);
  }
  if (before_.time_offset_s == 0.0) before_ = after_;
  if (after_.time_offset_s == 0.0) after_ = before_;
}

Pose SensorPath::at(double time_offset_s) const {
  const Neighbour& other = time_offset_s < 0.0 ? before_ : after_;
  if (other.time_offset_s == 0.0 || time_offset_s == 0.0) return T_map_sensor_;
  return T_map_sensor_ *
         interpolate(Pose::Identity(), other.T_stamp_other, time_offset_s / other.time_offset_s);
}

}  // namespace hqslam::slam
