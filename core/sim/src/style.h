#pragma once

#include <array>
#include <string_view>

namespace hqslam::sim {

/// The kinds of block that a city is made of.
enum class BlockKind { kRowHouses, kDetachedHouses, kSquare, kPark, kWalled, kOpenLand };

struct CityStyle {
  int streets = 3;              ///< per direction
  double min_spacing_m = 60.0;  ///< between neighbouring streets
  double max_spacing_m = 120.0;
  double bend = 0.2;                      ///< tangent of the angle by which streets wind
  double closed_street_share = 0.0;       ///< of the streets have one stretch built over
  double slope_bound = 0.05;              ///< of the terrain
  std::array<double, 6> block_weights{};  ///< in the order of BlockKind
  double parked_car_share = 0.6;          ///< of the places to park
  double seconds_between_cars = 12.0;     ///< on each lane
  int pedestrians_per_block = 3;
};

struct DriverStyle {
  double min_limit_mps = 8.0;  ///< speed limits of the streets
  double max_limit_mps = 14.0;
  double lateral_acceleration_mps2 = 2.5;
  double acceleration_mps2 = 1.8;
  double braking_mps2 = 2.2;
  double stop_share = 0.25;    ///< of the crossings where the driver stops
  int max_circuit_blocks = 2;  ///< longest side of a loop through the streets
  bool follows_car = false;    ///< another car drives ahead all the time
};

struct DriveStyle {
  CityStyle city;
  DriverStyle driver;
};

/// Of block, town or hills. Throws Error that lists them for any other.
DriveStyle drive_style(std::string_view name);

}  // namespace hqslam::sim
