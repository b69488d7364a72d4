#include "style.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "hqslam/core/error.h"
#include "hqslam/sim/drive.h"

namespace hqslam::sim {

namespace {

constexpr double kNever_s = std::numeric_limits<double>::infinity();

/// As many streets of both axes.
constexpr std::array<StreetGrid, 2> square(const StreetGrid& grid) { return {grid, grid}; }

/// Blocks of one kind, with or without another among them.
constexpr BlockWeights blocks_of(BlockKind kind, double weight = 1.0, double row_houses = 0.0) {
  BlockWeights weights{};
  weights[static_cast<std::size_t>(BlockKind::kRowHouses)] = row_houses;
  weights[static_cast<std::size_t>(kind)] = weight;
  return weights;
}

constexpr CityStyle kQuietStreets = {
    .grid = square({3, 50.0, 62.0}), .bend = 0.12, .block_weights = {3.5, 3.5, 0.7, 1.0, 0.0, 0.0}};

constexpr DriveStyle kBlock = {.city = kQuietStreets,
                               .driver = {.min_limit_mps = 8.0,
                                          .max_limit_mps = 10.0,
                                          .lateral_acceleration_mps2 = 3.0,
                                          .acceleration_mps2 = 2.0,
                                          .braking_mps2 = 2.5,
                                          .stop_share = 0.0,
                                          .max_circuit_blocks = 1}};

constexpr DriveStyle kTown = {.city = {.grid = square({7, 62.0, 125.0}),
                                       .bend = 0.25,
                                       .closed_street_share = 0.5,
                                       .slope_bound = 0.16,
                                       .block_weights = {3.0, 3.6, 0.9, 1.3, 0.8, 0.4},
                                       .parked_car_share = 0.55},
                              .driver = {.min_limit_mps = 8.5, .max_limit_mps = 14.5}};

constexpr DriveStyle kHills = {.city = {.grid = square({9, 70.0, 150.0}),
                                        .bend = 0.35,
                                        .closed_street_share = 0.6,
                                        .slope_bound = 0.36,
                                        .block_weights = {2.6, 3.2, 0.6, 1.2, 1.5, 1.7},
                                        .parked_car_share = 0.5,
                                        .seconds_between_cars = 8.0},
                               .driver = {.min_limit_mps = 10.0,
                                          .max_limit_mps = 19.0,
                                          .lateral_acceleration_mps2 = 4.5,
                                          .acceleration_mps2 = 2.8,
                                          .braking_mps2 = 3.5,
                                          .stop_share = 0.15,
                                          .max_circuit_blocks = 3,
                                          .follows_car = true}};

/// Country roads between fields: beside the ground there is little to see.
constexpr DriveStyle kMeadow = {
    .city = {.grid = square({5, 220.0, 380.0}),
             .plain_streets = PlainStreets{.half_width_m = 3.1, .lane_offset_m = 1.5},
             .bend = 0.35,
             .closed_street_share = 0.5,
             .slope_bound = 0.1,
             .block_weights = blocks_of(BlockKind::kField),
             .rim_trees_per_m = 1.0 / 80.0,
             .seconds_between_cars = 60.0},
    .driver = {.min_limit_mps = 11.0,
               .max_limit_mps = 20.0,
               .lateral_acceleration_mps2 = 3.0,
               .stop_share = 0.1,
               .max_circuit_blocks = 1}};

/// Alleys of seven metres between long smooth walls.
constexpr DriveStyle kNarrow = {
    .city = {.grid = square({6, 45.0, 120.0}),
             .plain_streets = PlainStreets{.half_width_m = 2.8, .lane_offset_m = 1.3},
             .closed_street_share = 0.6,
             .slope_bound = 0.08,
             .block_weights = blocks_of(BlockKind::kSmoothWalls, 6.0, 1.0),
             .seconds_between_cars = 40.0,
             .pedestrians_per_block = 2},
    .driver = {.min_limit_mps = 5.0, .max_limit_mps = 9.0, .lateral_acceleration_mps2 = 2.0}};

constexpr DriverStyle kOnFoot = {.min_limit_mps = 1.1,
                                 .max_limit_mps = 1.6,
                                 .lateral_acceleration_mps2 = 1.0,
                                 .acceleration_mps2 = 0.8,
                                 .braking_mps2 = 0.8,
                                 .stop_share = 0.1,
                                 .max_circuit_blocks = 1};
constexpr DriveStyle kHandheld = {.city = kQuietStreets, .driver = kOnFoot, .hand = HandStyle{}};
/// Turned to and fro, at up to 200 degrees a second.
constexpr DriveStyle kTurning = {
    .city = kQuietStreets, .driver = kOnFoot, .hand = HandStyle{.turn_rad = 1.05}};
/// Turned by up to 45 degrees from one scan to the next, half a second later.
constexpr DriveStyle kSparse = {.city = kQuietStreets,
                                .driver = kOnFoot,
                                .hand = HandStyle{.turn_rad = 0.45},
                                .turns_per_scan = 5};

/// Rows of parked cars; every place is passed in both directions.
constexpr DriveStyle kCarPark = {
    .city = {.grid = {StreetGrid{5, 16.6, 17.4}, StreetGrid{3, 55.0, 75.0}},
             .plain_streets = PlainStreets{.half_width_m = 3.2, .lane_offset_m = 1.3},
             .bend = 0.03,
             .slope_bound = 0.03,
             .block_weights = blocks_of(BlockKind::kParkingRows),
             .rim_block_weights = BlockWeights{0.5, 0.4, 0.0, 0.6, 0.5, 0.3},
             .parked_car_share = 0.75,
             .seconds_between_cars = kNever_s,
             .pedestrians_per_block = 2},
    .driver = {.route = RouteKind::kLoopBothWays,
               .start_m = 5.0,
               .min_limit_mps = 3.5,
               .max_limit_mps = 5.5,
               .lateral_acceleration_mps2 = 2.0,
               .stop_share = 0.1}};

/// A style's city and driver at a busy hour: four times as many cars and walkers.
constexpr DriveStyle busy(DriveStyle style) {
  style.city.seconds_between_cars /= 4.0;
  style.city.pedestrians_per_block *= 4;
  return style;
}
constexpr DriveStyle kBusyTown = busy(kTown);
constexpr DriveStyle kBusyHills = busy(kHills);

/// The drives that have a name. Where the sensor is not on a car's roof, its height.
struct NamedDrive {
  std::string_view name;
  const DriveStyle* style;  ///< null: no streets
  std::int64_t scans;
  double sensor_height_m = SensorMount{}.sensor_height_m;
};

constexpr std::array<NamedDrive, 12> kDrives = {{
    {"block", &kBlock, 200},
    {"town", &kTown, 4000},
    {"hills", &kHills, 8000},
    {"town-busy", &kBusyTown, 4000},
    {"hills-busy", &kBusyHills, 8000},
    {"meadow", &kMeadow, 4000},
    {"narrow", &kNarrow, 3000},
    {"handheld", &kHandheld, 2000, 1.5},
    {"handheld-turning", &kTurning, 2000, 1.5},
    {"handheld-sparse", &kSparse, 400, 1.5},
    {"car-park", &kCarPark, 2000},
    {"indoors", nullptr, 2000, 1.4},
}};

const NamedDrive& named_drive(std::string_view name) {
  const auto found = std::ranges::find(kDrives, name, &NamedDrive::name);
  if (found == kDrives.end()) {
    throw Error("unknown drive '{}': expected one of {}", name,
                fmt::join(drive_preset_names(), ", "));
  }
  return *found;
}

}  // namespace

bool has_streets(std::string_view name) { return named_drive(name).style != nullptr; }

DriveStyle drive_style(std::string_view name) {
  if (!has_streets(name)) {
    throw Error("drive '{}' has no streets; choose another", name);
  }
  return *named_drive(name).style;
}

DriveSpec drive_preset(std::string_view name) {
  const NamedDrive& drive = named_drive(name);
  DriveSpec spec;
  spec.name = name;
  spec.scans = drive.scans;
  spec.mount.sensor_height_m = drive.sensor_height_m;
  return spec;
}

std::vector<std::string> drive_preset_names() {
  std::vector<std::string> names;
  for (const NamedDrive& drive : kDrives) names.emplace_back(drive.name);
  return names;
}

}  // namespace hqslam::sim
