#include "style.h"

#include <fmt/format.h>

#include "hqslam/core/error.h"
#include "hqslam/sim/drive.h"

namespace hqslam::sim {

namespace {

DriveStyle block_style() {
  DriveStyle style;
  style.city = {.streets = 3,
                .min_spacing_m = 50.0,
                .max_spacing_m = 62.0,
                .bend = 0.12,
                .closed_street_share = 0.0,
                .slope_bound = 0.05,
                .block_weights = {3.5, 3.5, 0.7, 1.0, 0.0, 0.0},
                .parked_car_share = 0.6,
                .seconds_between_cars = 14.0,
                .pedestrians_per_block = 3};
  style.driver = {.min_limit_mps = 8.0,
                  .max_limit_mps = 10.0,
                  .lateral_acceleration_mps2 = 3.0,
                  .acceleration_mps2 = 2.0,
                  .braking_mps2 = 2.5,
                  .stop_share = 0.0,
                  .max_circuit_blocks = 1,
                  .follows_car = false};
  return style;
}

DriveStyle town_style() {
  DriveStyle style;
  style.city = {.streets = 7,
                .min_spacing_m = 62.0,
                .max_spacing_m = 125.0,
                .bend = 0.25,
                .closed_street_share = 0.5,
                .slope_bound = 0.16,
                .block_weights = {3.0, 3.6, 0.9, 1.3, 0.8, 0.4},
                .parked_car_share = 0.55,
                .seconds_between_cars = 14.0,
                .pedestrians_per_block = 3};
  style.driver = {.min_limit_mps = 8.5,
                  .max_limit_mps = 14.5,
                  .lateral_acceleration_mps2 = 2.5,
                  .acceleration_mps2 = 1.8,
                  .braking_mps2 = 2.2,
                  .stop_share = 0.2,
                  .max_circuit_blocks = 2,
                  .follows_car = false};
  return style;
}

DriveStyle hills_style() {
  DriveStyle style;
  style.city = {.streets = 9,
                .min_spacing_m = 70.0,
                .max_spacing_m = 150.0,
                .bend = 0.35,
                .closed_street_share = 0.6,
                .slope_bound = 0.36,
                .block_weights = {2.6, 3.2, 0.6, 1.2, 1.5, 1.7},
                .parked_car_share = 0.5,
                .seconds_between_cars = 8.0,
                .pedestrians_per_block = 3};
  style.driver = {.min_limit_mps = 10.0,
                  .max_limit_mps = 19.0,
                  .lateral_acceleration_mps2 = 4.5,
                  .acceleration_mps2 = 2.8,
                  .braking_mps2 = 3.5,
                  .stop_share = 0.15,
                  .max_circuit_blocks = 3,
                  .follows_car = true};
  return style;
}

}  // namespace

DriveStyle drive_style(std::string_view name) {
  if (name == "block") return block_style();
  if (name == "town") return town_style();
  if (name == "hills") return hills_style();
  throw Error(fmt::format("unknown drive '{}': expected block, town or hills", name));
}

DriveSpec drive_preset(std::string_view name) {
  static_cast<void>(drive_style(name));
  DriveSpec spec;
  spec.name = name;
  spec.scans = name == "block" ? 200 : name == "town" ? 4000 : 8000;
  return spec;
}

std::vector<std::string> drive_preset_names() { return {"block", "town", "hills"}; }

}  // namespace hqslam::sim
