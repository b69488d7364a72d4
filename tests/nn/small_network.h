#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/hqs/tiles.h"
#include "hqslam/nn/hqs/unrolled_network.h"

// Networks of a few thousand parameters on images of 16 x 64 pixels; tools/make_golden.py has the
// same sensor and scene.
namespace hqslam::nn {

inline SensorModel small_sensor() {
  SensorModel sensor;
  sensor.name = "small";
  sensor.columns = 64;
  for (int row = 0; row < 16; ++row) {
    sensor.beam_elevation_rad.push_back((6.0 - 1.5 * row) * std::numbers::pi / 180.0);
  }
  sensor.beam_azimuth_offset_rad.assign(16, 0.0);
  return sensor;
}

/// Walls round about, a box and poles in front of them, and no return in one corner.
inline RangeImage small_scene() {
  RangeImage image(16, 64);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const double azimuth_rad = 2.0 * std::numbers::pi * column / image.columns;
      double range_m = 12.0 + 4.0 * std::sin(azimuth_rad) - 0.25 * row;
      if (row >= 5 && column >= 20 && column < 31) range_m = 5.0;
      for (const int pole : {6, 13, 37, 60}) range_m = column == pole ? 3.0 : range_m;
      if (row < 8 && column >= 44 && column < 51) range_m = 0.0;
      image.at(row, column) = static_cast<float>(range_m);
    }
  }
  return image;
}

/// No filter inside.
inline NetworkDescription small_du_or() {
  NetworkDescription description;
  description.layers = 3;
  description.u_shaped = {.tile = {4, 4}, .channels = {6, 8}, .memory = 3, .negative_slope = 0.0F};
  description.sensor = small_sensor();
  description.measured_rows = {3, 4};
  description.filter.min_pixels = 0;
  return description;
}

inline NetworkDescription small_du_mix(const std::vector<TwoModesLayerShape>& layers) {
  NetworkDescription description = small_du_or();
  description.kind = NetworkKind::kDuMix;
  description.layers = static_cast<int>(layers.size());
  description.two_modes.layers = layers;
  description.two_modes.memory = layers.size() > 1 ? 3 : 0;
  description.two_modes.negative_slope = 0.125F;
  return description;
}

inline NetworkDescription small_simple_du() {
  NetworkDescription description = small_du_or();
  description.kind = NetworkKind::kSimpleDu;
  description.shared_weights = true;
  description.plain = {.features = 8, .convolutions = 5, .dropout = 0.0F};
  return description;
}

/// An image in units of range_scale_m.
inline std::vector<float> image_of(const NetworkDescription& description, const Tensor& tiles) {
  const TileSize tile = tile_of(description);
  std::vector<float> image(static_cast<std::size_t>(tile.pixels()) * tiles.rows() *
                           tiles.columns());
  from_tiles(tiles, tile, image.data());
  return image;
}

/// One run of a network: the state afterwards.
inline UnrolledState state_after(const NetworkDescription& description,
                                 const std::vector<float>& parameters, const RangeImage& measured,
                                 InstructionSet instruction_set = chosen_instruction_set(),
                                 int threads = 1) {
  UnrolledNetwork network(description, measured.columns, instruction_set, threads);
  network.set_parameters(parameters);
  UnrolledState state = network.make_state();
  network.start(measured, state);
  network.forward(state);
  network.finish_last_layer(state);
  return state;
}

}  // namespace hqslam::nn
