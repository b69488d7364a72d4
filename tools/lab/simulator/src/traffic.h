#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <vector>

#include "driver_path.h"
#include "layout.h"
#include "random.h"
#include "style.h"

namespace hqslam::sim {

/// An actor's motion during one scan: on a straight line from one pose to the other.
struct ActorMotion {
  int prototype = 0;
  Eigen::Affine3d T_world_at_start = Eigen::Affine3d::Identity();
  Eigen::Affine3d T_world_at_end = Eigen::Affine3d::Identity();
  std::uint8_t shade = 128;
};

/// Cars that drive through the city from end to end and people who walk around blocks. An actor
/// that would come too close to the sensor's car never sets out.
class Traffic {
 public:
  /// Trips that begin before `until_s`; `ego` must last some minutes longer.
  Traffic(const Layout& layout, const DriveStyle& style, const DriverPath& ego, std::uint64_t seed,
          double until_s);
  /// The actors within reach of the sensor at `plane_m`, the nearest first.
  std::vector<ActorMotion> actors(double from_s, double to_s, const Eigen::Vector2d& plane_m) const;

 private:
  struct Actor {
    int prototype;
    std::uint8_t shade;
    double start_s;
    double end_s;
    std::function<Eigen::Vector2d(double time_s)> sheet_at;
    std::function<Eigen::Affine3d(double time_s)> pose_at;
  };

  void add_trips(const DriveStyle& style, std::uint64_t seed, double until_s);
  void add_trips_on(const Street& street, int axis, double direction, double interval_s,
                    double until_s, Random random);
  void add_walkers(const CityStyle& style, std::uint64_t seed);
  bool meets_ego(const Actor& car) const;
  Eigen::Affine3d pose_of_car_ahead(double time_s) const;

  const Layout& layout_;
  const DriverPath& ego_;
  std::vector<Actor> actors_;  ///< cars, then walkers
  bool car_ahead_;
};

}  // namespace hqslam::sim
