#pragma once

#include <cstddef>

#include "hqslam/core/pose.h"
#include "hqslam/core/trajectory.h"

namespace hqslam::slam {

/// The motion of a sensor while it captures a scan: even from its pose at the stamp of the scan
/// before to that at the scan's own stamp, and on to that of the next. It needs a finished
/// trajectory.
class SensorPath {
 public:
  /// A sensor that stands still.
  explicit SensorPath(const Pose& T_map_sensor) : T_map_sensor_(T_map_sensor) {}
  /// The path of one scan of a trajectory. At its ends, and next to stamps that do not rise, the
  /// motion on the other side continues; without either the sensor stands still. Throws Error if
  /// there is no such scan.
  SensorPath(const Trajectory& trajectory, std::size_t scan);

  /// The pose at a time after (or before) the scan's stamp:
  ///   T_map_sensor(t) = T_map_sensor interpolate(I, T_stamp_other, t / t_other),
  /// "other" being the next scan for t > 0 and the one before for t < 0.
  Pose at(double time_offset_s) const;

 private:
  struct Neighbour {
    Pose T_stamp_other = Pose::Identity();
    double time_offset_s = 0.0;  ///< of its stamp from the scan's; 0: no neighbour
  };
  Pose T_map_sensor_;
  Neighbour before_;
  Neighbour after_;
};

}  // namespace hqslam::slam
