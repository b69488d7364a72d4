#pragma once

#include <cstddef>

#include "hqslam/core/pose.h"
#include "hqslam/core/trajectory.h"

namespace hqslam::slam {

/// Where a sensor is while it captures a scan: from its pose at the stamp of the scan before it
/// moves evenly to that at the scan's own stamp, and on to that of the next. Beside SensorMotion,
/// which knows only what was before, this needs a trajectory that is finished.
class SensorPath {
 public:
  /// Stands still.
  explicit SensorPath(const Pose& T_map_sensor) : T_map_sensor_(T_map_sensor) {}
  /// On which sides of a scan the next pose is known to be on the same path.
  struct KnownWay {
    bool before = true;
    bool after = true;
  };
  /// Of one scan of a trajectory. At its ends, where the way is not known, and next to stamps that
  /// do not rise, the motion on the other side goes on; without either the sensor stands still.
  /// Throws Error if there is no such scan.
  SensorPath(const Trajectory& trajectory, std::size_t scan, const KnownWay& way);
  SensorPath(const Trajectory& trajectory, std::size_t scan) : SensorPath(trajectory, scan, {}) {}

  /// The pose at a time after (or before) the scan's stamp:
  ///   T_map_sensor(t) = T_map_sensor interpolate(I, T_stamp_other, t / t_other),
  /// "other" being the next scan for t > 0 and the one before for t < 0.
  Pose at(double time_offset_s) const;

 private:
  struct Neighbour {
    Pose T_stamp_other = Pose::Identity();
    double time_offset_s = 0.0;  ///< of its stamp; 0: none
  };
  Pose T_map_sensor_;
  Neighbour before_;
  Neighbour after_;
};

}  // namespace hqslam::slam
