#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "city.h"
#include "hqslam/core/pose.h"
#include "hqslam/sim/drive.h"
#include "traffic.h"

namespace hqslam::sim {

/// The inputs of a simulated drive: scenery, motion of the sensor, actors. The same spec makes the
/// same scenario, up to its duration.
struct Scenario {
  std::shared_ptr<const Scenery> scenery;
  std::function<Pose(double time_s)> T_world_sensor;
  /// The actors near the sensor during a scan, the nearest first.
  std::function<std::vector<ActorMotion>(double from_s, double to_s,
                                         const Eigen::Vector2d& plane_m)>
      actors;
};

/// Throws Error for an unknown drive.
Scenario make_scenario(const DriveSpec& spec, double duration_s);

}  // namespace hqslam::sim
