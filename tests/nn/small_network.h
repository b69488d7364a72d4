#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "hqs/du_mix.h"
#include "hqs/plain_denoiser.h"
#include "hqs/u_shaped_denoiser.h"
#include "hqs/unrolled_hqs.h"
#include "hqs/unrolled_network.h"
#include "hqslam/core/range_image.h"
#include "tiles.h"

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

/// An unrolled network as a test likes it: the options, and the sizes of its denoiser.
struct UnrolledPlan : HqsOptions {
  std::string kind = "du-or";
  UShapedDenoiserShape u_shaped;  ///< of "du-or"
  PlainDenoiserShape plain;       ///< of "simple-du"
  SensorModel sensor = small_sensor();
  RowSelection measured_rows{3, 4};
  float range_scale_m = 80.0F;

  bool simple() const { return kind == "simple-du"; }
  int penalties() const { return penalty == Penalty::kAlpha ? 1 : layers; }
  TileSize tile() const { return simple() ? TileSize{} : u_shaped.tile; }
  operator NetworkDescription() const {  // NOLINT: what a plan is for
    NetworkDescription d;
    d.architecture = std::make_shared<UnrolledHqs>(
        kind, *this, simple() ? plain_denoiser(plain) : u_shaped_denoiser(u_shaped));
    d.sensor = sensor;
    d.measured_rows = measured_rows;
    d.range_scale_m = range_scale_m;
    return d;
  }
};

/// No filter inside.
inline UnrolledPlan small_du_or() {
  UnrolledPlan plan;
  plan.layers = 3;
  plan.u_shaped = {.tile = {4, 4}, .channels = {6, 8}, .memory = 3, .negative_slope = 0.0F};
  plan.filter.min_pixels = 0;
  return plan;
}

inline UnrolledPlan small_simple_du() {
  UnrolledPlan plan;
  static_cast<HqsOptions&>(plan) = simple_du_options();
  plan.kind = "simple-du";
  plan.layers = 3;
  plan.plain = {.features = 8, .convolutions = 5, .dropout = 0.0F};
  plan.filter.min_pixels = 0;
  return plan;
}

inline NetworkDescription small_du_mix(const TwoModesShape& shape) {
  NetworkDescription description = small_du_or();
  description.architecture = std::make_shared<DuMix>(shape);
  return description;
}

inline TwoModesShape small_two_modes(const std::vector<TwoModesLayerShape>& layers) {
  return {.tile = {4, 4},
          .layers = layers,
          .memory = layers.size() > 1 ? 3 : 0,
          .negative_slope = 0.125F};
}

inline NetworkDescription small_du_mix(const std::vector<TwoModesLayerShape>& layers) {
  return small_du_mix(small_two_modes(layers));
}

/// An image in units of range_scale_m.
inline std::vector<float> image_of(const UnrolledPlan& plan, const Tensor& tiles) {
  const TileSize tile = plan.tile();
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
