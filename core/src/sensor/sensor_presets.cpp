#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <vector>

#include "hqslam/core/angles.h"
#include "hqslam/core/error.h"
#include "hqslam/core/nearest_names.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam {

namespace {

std::vector<double> evenly_spaced_rad(double highest_deg, double lowest_deg, int rows) {
  std::vector<double> result;
  for (int row = 0; row < rows; ++row) {
    result.push_back(radians(highest_deg + (lowest_deg - highest_deg) * row / (rows - 1)));
  }
  return result;
}

SensorModel sensor(std::string name, int columns, double min_range_m, double max_range_m,
                   std::vector<double> elevation_rad, std::vector<double> azimuth_offset_rad = {}) {
  SensorModel result;
  result.name = std::move(name);
  result.columns = columns;
  result.min_range_m = min_range_m;
  result.max_range_m = max_range_m;
  if (azimuth_offset_rad.empty()) azimuth_offset_rad.assign(elevation_rad.size(), 0.0);
  result.beam_elevation_rad = std::move(elevation_rad);
  result.beam_azimuth_offset_rad = std::move(azimuth_offset_rad);
  return result;
}

/// Ouster OS1-64, first generation, as one unit's metadata gives it: beams about 0.53 degrees
/// apart, in four columns whose azimuths differ by about 2.1 degrees.
SensorModel os1_64() {
  const std::vector<double> elevation_deg = {
      16.46,  15.88,  15.32,  14.80,  14.29,  13.71,  13.17,  12.63,  12.15,  11.58,  11.05,
      10.52,  10.05,  9.49,   8.95,   8.43,   7.95,   7.41,   6.88,   6.34,   5.87,   5.33,
      4.80,   4.27,   3.79,   3.26,   2.72,   2.19,   1.71,   1.18,   0.65,   0.12,   -0.36,
      -0.90,  -1.43,  -1.96,  -2.44,  -2.97,  -3.51,  -4.04,  -4.52,  -5.05,  -5.58,  -6.12,
      -6.61,  -7.13,  -7.67,  -8.22,  -8.70,  -9.22,  -9.76,  -10.30, -10.80, -11.33, -11.86,
      -12.43, -12.91, -13.45, -14.00, -14.57, -15.07, -15.60, -16.17, -16.75};
  const std::vector<double> clockwise_deg = {
      3.12,  0.97,  -1.18, -3.30, 3.09,  0.97,  -1.15, -3.25, 3.09,  0.98,  -1.12, -3.21, 3.08,
      0.99,  -1.09, -3.17, 3.08,  1.00,  -1.06, -3.15, 3.08,  1.02,  -1.05, -3.12, 3.10,  1.03,
      -1.04, -3.10, 3.11,  1.04,  -1.03, -3.09, 3.12,  1.04,  -1.01, -3.09, 3.14,  1.07,  -1.00,
      -3.08, 3.15,  1.07,  -1.00, -3.08, 3.17,  1.08,  -0.99, -3.10, 3.19,  1.10,  -0.98, -3.09,
      3.23,  1.12,  -0.99, -3.11, 3.24,  1.12,  -1.00, -3.13, 3.29,  1.14,  -1.01, -3.17};
  std::vector<double> counter_clockwise_rad = radians(clockwise_deg);
  for (double& offset_rad : counter_clockwise_rad) offset_rad = -offset_rad;
  return sensor("os1-64", 1024, 0.8, 120.0, radians(elevation_deg), counter_clockwise_rad);
}

/// Velodyne HDL-64E S2, median elevations measured on KITTI scans.
SensorModel hdl_64e() {
  const std::vector<double> elevation_deg = {
      2.323,   1.957,   1.700,   1.251,   0.978,   0.570,   0.305,   -0.065,  -0.414,  -0.815,
      -1.101,  -1.448,  -1.802,  -2.123,  -2.440,  -2.773,  -3.055,  -3.423,  -3.676,  -4.026,
      -4.324,  -4.644,  -4.970,  -5.290,  -5.635,  -5.951,  -6.246,  -6.506,  -6.868,  -7.207,
      -7.433,  -7.801,  -8.398,  -8.915,  -9.376,  -9.765,  -10.225, -10.820, -11.313, -11.734,
      -12.185, -12.607, -13.131, -13.648, -14.214, -14.650, -15.145, -15.504, -16.116, -16.637,
      -17.197, -17.652, -18.150, -18.550, -19.005, -19.548, -20.057, -20.655, -21.140, -21.538,
      -21.983, -22.617, -23.140, -23.620};
  return sensor("hdl-64e", 1024, 1.0, 120.0, radians(elevation_deg));
}

/// Velodyne VLS-128 (Alpha Prime): 0.11 degrees between beams in the middle, wider outside, in
/// eight columns of lasers.
SensorModel vls_128() {
  const std::vector<double> elevation_deg = {
      15,     11.75,   9.7,     8.43,    7.58,    6.98,    6.48,  6.08,  5.73,  5.43,  5.18,
      4.98,   4.83,    4.72,    4.61,    4.5,     4.39,    4.28,  4.17,  4.06,  3.95,  3.84,
      3.73,   3.62,    3.51,    3.4,     3.29,    3.18,    3.07,  2.96,  2.85,  2.74,  2.63,
      2.52,   2.41,    2.3,     2.19,    2.08,    1.97,    1.86,  1.75,  1.64,  1.53,  1.42,
      1.31,   1.2,     1.09,    0.98,    0.87,    0.76,    0.65,  0.54,  0.43,  0.32,  0.21,
      0.1,    -0.01,   -0.12,   -0.23,   -0.34,   -0.45,   -0.56, -0.67, -0.78, -0.89, -1,
      -1.11,  -1.22,   -1.33,   -1.44,   -1.55,   -1.66,   -1.77, -1.88, -1.99, -2.1,  -2.21,
      -2.32,  -2.43,   -2.54,   -2.65,   -2.76,   -2.87,   -2.98, -3.09, -3.2,  -3.31, -3.42,
      -3.53,  -3.64,   -3.75,   -3.86,   -3.97,   -4.08,   -4.19, -4.3,  -4.41, -4.52, -4.63,
      -4.74,  -4.85,   -4.96,   -5.07,   -5.18,   -5.29,   -5.4,  -5.51, -5.62, -5.73, -5.84,
      -5.95,  -6.06,   -6.17,   -6.28,   -6.39,   -6.5,    -6.65, -6.85, -7.15, -7.65, -8.352,
      -9.244, -10.346, -11.742, -13.565, -16.042, -19.582, -25};
  constexpr std::array<double, 8> kCounterClockwise_deg = {-0.911, -2.732, -4.548, -6.354,
                                                           6.354,  4.548,  2.732,  0.911};
  std::vector<double> counter_clockwise_deg;
  for (std::size_t row = 0; row < elevation_deg.size(); ++row) {
    counter_clockwise_deg.push_back(kCounterClockwise_deg[row % kCounterClockwise_deg.size()]);
  }
  return sensor("vls-128", 1800, 0.5, 245.0, radians(elevation_deg),
                radians(counter_clockwise_deg));
}

SensorModel os1_16() {
  SensorModel result = select_rows(os1_64(), selection_for(64, 16));
  result.name = "os1-16";
  return result;
}

SensorModel hdl_32e() {
  return sensor("hdl-32e", 1800, 1.0, 100.0, evenly_spaced_rad(10.67, -30.67, 32));
}

/// Velodyne VLP-32C (Ultra Puck): beams a third of a degree apart in the middle, wider outside, in
/// four columns of lasers.
SensorModel vlp_32c() {
  const std::vector<double> elevation_deg = {
      15,     10.333, 7,      4.667,  3.333,  2.333,  1.667,  1.333,  1,       0.667, 0.333,
      0,      -0.333, -0.667, -1,     -1.333, -1.667, -2,     -2.333, -2.667,  -3,    -3.333,
      -3.667, -4,     -4.667, -5.333, -6.148, -7.254, -8.843, -11.31, -15.639, -25};
  const std::vector<double> counter_clockwise_deg = {
      1.4,  -1.4, 1.4, -1.4, 1.4,  -1.4, 4.2, 1.4, -1.4, -4.2, 4.2, 1.4,  -1.4, -4.2, 4.2, 1.4,
      -1.4, -4.2, 4.2, 1.4,  -1.4, -4.2, 4.2, 1.4, -1.4, -4.2, 1.4, -1.4, 1.4,  -1.4, 1.4, -1.4};
  return sensor("vlp-32c", 1800, 0.5, 200.0, radians(elevation_deg),
                radians(counter_clockwise_deg));
}

SensorModel vlp_16() {
  return sensor("vlp-16", 1800, 0.5, 100.0, evenly_spaced_rad(15.0, -15.0, 16));
}

struct Preset {
  std::string_view name;
  SensorModel (*make)();
};
constexpr std::array<Preset, 7> kPresets = {{{"os1-64", os1_64},
                                             {"os1-16", os1_16},
                                             {"hdl-64e", hdl_64e},
                                             {"hdl-32e", hdl_32e},
                                             {"vlp-16", vlp_16},
                                             {"vlp-32c", vlp_32c},
                                             {"vls-128", vls_128}}};

}  // namespace

std::vector<std::string> sensor_preset_names() {
  std::vector<std::string> names;
  for (const Preset& preset : kPresets) names.emplace_back(preset.name);
  return names;
}

SensorModel sensor_preset(std::string_view name) {
  for (const Preset& preset : kPresets) {
    if (preset.name == name) return preset.make();
  }
  throw Error("unknown sensor '{}': expected one of {} or a .json file{}", name,
              fmt::join(sensor_preset_names(), ", "), did_you_mean(name, sensor_preset_names()));
}

}  // namespace hqslam
