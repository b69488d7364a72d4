#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "du_mix.h"

namespace hqslam::nn::reference {
namespace {

/// (ln L - ln 20) / 2 of the measured rows alone: tile columns x measured rows x columns / those.
Image measured_tiles(const Run& run, const Measured& m, int tile_columns) {
  Image tiles = zeros(tile_columns, run.measured_m.rows, run.columns() / tile_columns);
  for (int y = 0; y < run.measured_m.rows; ++y) {
    for (int x = 0; x < run.columns(); ++x) {
      tiles(x % tile_columns, y, x / tile_columns) =
          0.5 * (std::log(m.filled(0, y, x)) - std::log(kTypicalRange_m));
    }
  }
  return tiles;
}

/// With a memory two channels for each pixel of a tile from channel `first` on: M - start, within
/// +-1; share - 1/2. For any beams for the rows 3/4, 1/2 and 1/4 of the gap above the measured one,
/// and for that one.
void put_recalled(const Run& run, const MixImages& images, int first, Image& input) {
  const int tile_rows = run.network["denoiser"]["tile_rows"];
  const int tile_columns = run.network["denoiser"]["tile_columns"];
  const bool any_beams = run.network["denoiser"].value("any_beams", false);
  const Recalled& recalled = images.recalled;
  for (int y = 0; y < run.rows(); ++y) {
    const double above =
        static_cast<double>(tile_rows - 1 - y % tile_rows) / tile_rows;  // of a gap
    const int slot = any_beams ? 3 - static_cast<int>(std::round(4.0 * above)) : y % tile_rows;
    for (int x = 0; x < run.columns(); ++x) {
      const int channel = first + 2 * (slot * tile_columns + x % tile_columns);
      const double share = recalled.share(0, y, x);
      const double without = run.is_measured(y)
                                 ? std::log(images.measured.filled(0, y / tile_rows, x))
                                 : images.start(0, y, x);
      const double step = share > 0.0 ? std::clamp(recalled.m(0, y, x) - without, -1.0, 1.0) : 0.0;
      input(channel, y / tile_rows, x / tile_columns) = step;
      input(channel + 1, y / tile_rows, x / tile_columns) = share - 0.5;
    }
  }
}

/// The input on tiles, 16 + 4 + 4 x 16 x 256 for 4 x 4 tiles and 64 x 1024 pixels: (H - ln 20) / 2;
/// valid - 1/2 of the tile's measured pixels; ln above - ln below of them, within +-1. For any
/// beams measured_tiles() in the place of H. With a memory two channels more for each of the 16
/// pixels: M - start, within +-1; share - 1/2.
Image input_of(const Run& run, const MixImages& images) {
  const int tile_rows = run.network["denoiser"]["tile_rows"];
  const int tile_columns = run.network["denoiser"]["tile_columns"];
  const Measured& m = images.measured;
  const Image centred = (images.h - std::log(kTypicalRange_m)) * 0.5;
  const bool any_beams = run.network["denoiser"].value("any_beams", false);
  const Image tiles =
      any_beams ? measured_tiles(run, m, tile_columns) : tiled(centred, tile_rows, tile_columns);
  const auto pixels = static_cast<int>(tiles.dimension(0));  // of a tile, for any beams of a row
  // For any beams the rows 3/4, 1/2 and 1/4 of the gap above the measured one, and that one.
  const int recalled_rows = any_beams ? 4 : tile_rows;
  const bool has_memory = run.network["denoiser"].value("scan_memory", false);
  const int first_recalled = pixels + 2 * tile_columns;
  const Image others = zeros(2 * tile_columns + (has_memory ? 2 * recalled_rows * tile_columns : 0),
                             tiles.dimension(1), tiles.dimension(2));
  Image input = tiles.concatenate(others, 0);
  for (int y = 0; y < tiles.dimension(1); ++y) {
    for (int x = 0; x < run.columns(); ++x) {
      const int channel = pixels + x % tile_columns;
      const double above_m = m.filled(0, std::max(y - 1, 0), x);
      const double step = std::log(above_m) - std::log(m.filled(0, y, x));
      input(channel, y, x / tile_columns) = m.valid(0, y, x) - 0.5;
      input(channel + tile_columns, y, x / tile_columns) = std::clamp(step, -1.0, 1.0);
    }
  }
  for (int channel = first_recalled + 1; channel < input.dimension(0); channel += 2) {
    input.chip(channel, 0).setConstant(-0.5);  // where no row of the tile is
  }
  if (has_memory) put_recalled(run, images, first_recalled, input);
  return input;
}

/// Adds the first layer's bias of each row, which other layers do not have.
void add_row_biases(const Run& run, Image& encoded) {
  const bool any_beams = run.network["denoiser"].value("any_beams", false);
  const std::string name = any_beams ? "beam_bias" : "row_bias";
  const Array& biases = run.parameters["layers.0.encoder.0." + name];
  for (int c = 0; c < encoded.dimension(0); ++c) {
    for (int y = 0; y < encoded.dimension(1); ++y) {
      const double bias =
          any_beams ? beam_bias(run, biases, c, y) : biases.values[c * encoded.dimension(1) + y];
      for (int x = 0; x < encoded.dimension(2); ++x) encoded(c, y, x) += bias;
    }
  }
}

/// The convolutions, channels c, lower channels l: c x 16 x 256 -> l x 8 x 128 -> residual blocks
/// -> c x 16 x 256 -> 7 outputs of each computed pixel of a tile, 84 x 16 x 256 (9 with a memory).
Image outputs_of(Run& run, const Image& input) {
  const nlohmann::json& sizes = run.network["denoiser"];
  const double slope = sizes["negative_slope"];
  const int blocks = sizes["layers"][0]["residual_blocks"];
  const std::string prefix = "layers.0.";
  const auto array = [&](const std::string& name) -> const Array& {
    return run.parameters[prefix + name];
  };
  const auto convolved = [&](const std::string& name, const Image& in, int stride = 1) {
    return convolution(in, array(name + ".weight"), &array(name + ".bias"), stride);
  };
  const auto named = [&](const std::string& name, const Image& image) {
    run.add(prefix + name, image);
    return image;
  };
  Image encoded = convolved("encoder.0", input);
  add_row_biases(run, encoded);
  encoded = named("encoder.0", activated(encoded, slope));
  Image x = named("encoder.1", activated(convolved("encoder.1", encoded, 2), slope));
  x = named("bottleneck.0", activated(convolved("bottleneck.0", x), slope));
  for (int block = 1; block <= blocks; ++block) {
    const std::string name = fmt::format("bottleneck.{}", block);
    x = named(name, activated(convolved(name, x) + x, slope));
  }
  x = transposed_convolution(x, array("decoder.0.weight"), array("decoder.0.bias"));
  x = named("decoder.0", activated(x + encoded, slope));
  if (sizes.value("any_beams", false)) {
    return head_of_rows(run, x, array("head.weight"), array("head.bias"));
  }
  return convolved("head", x);
}

}  // namespace

Image du_mix_prior(Run& run, const MixImages& images) {
  return outputs_of(run, input_of(run, images));
}

}  // namespace hqslam::nn::reference
