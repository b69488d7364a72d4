#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace hqslam::sim {

/// The kinds of block that a city is made of. From kField on they are level with the street and
/// have no sidewalk.
enum class BlockKind {
  kRowHouses,
  kDetachedHouses,
  kSquare,
  kPark,
  kWalled,
  kOpenLand,
  kField,
  kSmoothWalls,
  kParkingRows,
};
constexpr std::size_t kBlockKinds = 9;
/// How often each kind of block occurs, in the order of BlockKind.
using BlockWeights = std::array<double, kBlockKinds>;

/// Parallel streets and how far they are apart.
struct StreetGrid {
  int streets = 3;
  double min_spacing_m = 60.0;
  double max_spacing_m = 120.0;
};

/// Streets of one width without parked cars and trees.
struct PlainStreets {
  double half_width_m = 3.0;
  double lane_offset_m = 1.4;
};

struct CityStyle {
  std::array<StreetGrid, 2> grid;               ///< by the axis of the streets (see Street)
  std::optional<PlainStreets> plain_streets{};  ///< otherwise each street has its own width
  double bend = 0.2;                            ///< tangent of the angle by which streets wind
  double closed_street_share = 0.0;             ///< of the streets have one stretch built over
  double slope_bound = 0.05;                    ///< of the terrain
  BlockWeights block_weights{};
  std::optional<BlockWeights> rim_block_weights{};  ///< of the outermost blocks, where they differ
  double rim_trees_per_m = 1.0 / 7.0;  ///< trees in the open land, by length of the rim
  double parked_car_share = 0.6;       ///< of the places to park
  double seconds_between_cars = 14.0;  ///< on each lane; infinity: there are none
  int pedestrians_per_block = 3;
};

/// Circuits around blocks joined by short stretches, or one loop in alternating directions.
enum class RouteKind { kCircuits, kLoopBothWays };

struct DriverStyle {
  RouteKind route = RouteKind::kCircuits;
  double start_m = 18.0;       ///< from the first crossing
  double min_limit_mps = 8.0;  ///< speed limits of the streets
  double max_limit_mps = 14.0;
  double lateral_acceleration_mps2 = 2.5;
  double acceleration_mps2 = 1.8;
  double braking_mps2 = 2.2;
  double stop_share = 0.2;     ///< of the crossings where the driver stops
  int max_circuit_blocks = 2;  ///< longest side of a loop through the streets
  bool follows_car = false;    ///< another car drives ahead all the time
};

/// How far a hand swings the sensor while it walks.
struct HandStyle {
  double swing_rad = 0.17453292519943295;  ///< roll and pitch, once in a second
  double turn_rad = 0.3 * swing_rad;       ///< yaw, once in two seconds
};

struct DriveStyle {
  CityStyle city;
  DriverStyle driver;
  std::optional<HandStyle> hand{};  ///< carries the sensor; otherwise it is on wheels
  int turns_per_scan = 1;           ///< of the head, from one scan of the drive to the next
};

/// Whether a drive goes through streets and has a style. Throws Error for an unknown name.
bool has_streets(std::string_view name);
/// Throws Error for an unknown name and for a drive without streets.
DriveStyle drive_style(std::string_view name);

}  // namespace hqslam::sim
