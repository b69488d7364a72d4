#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "driver_path.h"
#include "layout.h"
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
  /// Trips that begin before `until_s`; `ego` must be known for some minutes longer.
  Traffic(const Layout& layout, const DriveStyle& style, const DriverPath& ego, std::uint64_t seed,
          double until_s);
  /// The actors within reach of the sensor at `plane_m`, the nearest first.
  std::vector<ActorMotion> actors(double from_s, double to_s, const Eigen::Vector2d& plane_m) const;

 private:
  struct Trip {
    int axis;
    double street_m;   ///< middle of the lane on the sheet, along `axis`
    double direction;  ///< +1 or -1 along the other axis
    double from_m;     ///< where it begins
    double length_m;
    double start_s;
    double speed_mps;
    int prototype;
    std::uint8_t shade;
    double end_s() const { return start_s + length_m / speed_mps; }
    Eigen::Vector2d sheet_at(double time_s) const;
  };
  struct Walker {
    Eigen::AlignedBox2d around_sheet_m;  ///< the rectangle that it walks around
    double start_m;
    double speed_mps;  ///< negative: clockwise
    int prototype;
    std::uint8_t shade;
    Eigen::Vector2d sheet_at(double time_s) const;
  };

  void add_trips(const DriveStyle& style, std::uint64_t seed, double until_s);
  void add_walkers(const CityStyle& style, std::uint64_t seed);
  bool meets_ego(const Trip& trip) const;
  Eigen::Affine3d pose_of(const Trip& trip, double time_s) const;
  Eigen::Affine3d pose_of(const Walker& walker, double time_s) const;
  Eigen::Affine3d pose_of_car_ahead(double time_s) const;

  const Layout& layout_;
  const DriverPath& ego_;
  std::vector<Trip> trips_;
  std::vector<Walker> walkers_;
  bool car_ahead_;
};

}  // namespace hqslam::sim
