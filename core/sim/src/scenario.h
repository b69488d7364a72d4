#pragma once

#include <memory>
#include <vector>

#include "city.h"
#include "hqslam/core/pose.h"
#include "hqslam/sim/drive.h"
#include "traffic.h"

namespace hqslam::sim {

/// What one drive is simulated from: what stands still, what moves, and how the sensor moves. The
/// same spec makes the same scenario, but for how far ahead it reaches.
class Scenario {
 public:
  virtual ~Scenario() = default;
  virtual const Scenery& scenery() const = 0;
  virtual Pose T_world_sensor(double time_s) const = 0;
  /// Who moves near the sensor during a scan, the nearest first.
  virtual std::vector<ActorMotion> actors(double from_s, double to_s,
                                          const Eigen::Vector2d& plane_m) const = 0;
};

/// Throws Error for a drive that is unknown.
std::unique_ptr<Scenario> make_scenario(const DriveSpec& spec, double duration_s);
/// Through the streets of a city.
std::unique_ptr<Scenario> make_street_scenario(const DriveSpec& spec, double duration_s);
/// On foot through a building of two storeys.
std::unique_ptr<Scenario> make_indoor_scenario(const DriveSpec& spec, double duration_s);

}  // namespace hqslam::sim
