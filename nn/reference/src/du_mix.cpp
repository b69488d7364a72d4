#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hqslam/core/angles.h"
#include "scan.h"

// DU-Mix: one layer of eq. 10 in the limit b -> 0, where what was measured stays, on logarithms of
// ranges (metres), with a prior that gives two modes and the probability of a return. An addition
// to the paper, which has one range per pixel.
namespace hqslam::nn::reference {
namespace {

constexpr double kTypicalRange_m = 20.0;

struct Measured {
  Image valid;   ///< measured rows x columns: 1 where there is a return
  Image filled;  ///< metres; no return takes the range above it, at the top a typical one
};

Measured measured(const Run& run) {
  const Image empty = zeros(1, run.measured_m.rows, run.columns());
  Measured m{empty, empty};
  for (int y = 0; y < run.measured_m.rows; ++y) {
    for (int x = 0; x < run.columns(); ++x) {
      const double range_m = run.measured_m.at(y, x);
      const bool there = range_m > 0.0;
      m.valid(0, y, x) = there ? 1.0 : 0.0;
      const double above_m = y == 0 ? kTypicalRange_m : m.filled(0, y - 1, x);
      m.filled(0, y, x) = there ? range_m : above_m;
    }
  }
  return m;
}

/// The place of an image row between the measured beams around it, by their elevations: on a plane
/// 1 / range is nearly linear in the elevation.
double part_down(const Run& run, int row, const Between& at) {
  if (at.above == at.below) return 0.0;
  const RowSelection rows = run.description.measured_rows;
  const std::vector<double>& elevation_rad = run.description.sensor.beam_elevation_rad;
  const double above_rad = elevation_rad[rows.offset + at.above * rows.stride];
  const double below_rad = elevation_rad[rows.offset + at.below * rows.stride];
  return (above_rad - elevation_rad[row]) / (above_rad - below_rad);
}

double logistic(double v) { return 1.0 / (1.0 + std::exp(-v)); }

/// What is recalled of each pixel; 0 where nothing is.
struct Recalled {
  Image m;      ///< ln of metres
  Image share;  ///< W^2 / (W^2 + 1)
};

Recalled recalled(const Run& run) {
  const Image empty = zeros(1, run.rows(), run.columns());
  Recalled r{empty, empty};
  const RecalledImage& given = run.options.recalled;
  for (int y = 0; y < run.rows() && !given.is_empty(); ++y) {
    for (int x = 0; x < run.columns(); ++x) {
      const double range_m = given.image.at(y, x);
      const double weight = given.weight[given.image.index(y, x)];
      if (!(range_m > 0.0) || !(weight > 0.0)) continue;
      r.m(0, y, x) = std::log(range_m);
      r.share(0, y, x) = weight / (weight + 1.0);
    }
  }
  return r;
}

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

/// The input on tiles, 16 + 4 + 4 x 16 x 256 for 4 x 4 tiles and 64 x 1024 pixels: (H - ln 20) / 2;
/// valid - 1/2 of the tile's measured pixels; ln above - ln below of them, within +-1. For any
/// beams measured_tiles() in the place of H. With a memory two channels more for each of the 16
/// pixels: M - start, within +-1; share - 1/2.
Image input_of(const Run& run, const Measured& m, const Image& start, const Recalled& recalled,
               const Image& h, int tile_rows, int tile_columns) {
  const Image centred = (h - std::log(kTypicalRange_m)) * 0.5;
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
  for (int y = 0; y < run.rows() && has_memory; ++y) {
    const double above =
        static_cast<double>(tile_rows - 1 - y % tile_rows) / tile_rows;  // of a gap
    const int slot = any_beams ? 3 - static_cast<int>(std::round(4.0 * above)) : y % tile_rows;
    for (int x = 0; x < run.columns(); ++x) {
      const int channel = first_recalled + 2 * (slot * tile_columns + x % tile_columns);
      const double share = recalled.share(0, y, x);
      const double without =
          run.is_measured(y) ? std::log(m.filled(0, y / tile_rows, x)) : start(0, y, x);
      const double step = share > 0.0 ? std::clamp(recalled.m(0, y, x) - without, -1.0, 1.0) : 0.0;
      input(channel, y / tile_rows, x / tile_columns) = step;
      input(channel + 1, y / tile_rows, x / tile_columns) = share - 0.5;
    }
  }
  return input;
}

/// Elevation of measured row i, degrees.
double beam_deg(const Run& run, int i) {
  const RowSelection rows = run.description.measured_rows;
  return degrees(run.description.sensor.beam_elevation_rad[rows.offset + i * rows.stride]);
}

/// e' = e / 20, with e within the elevations of training.
double elevation_place(double e_deg) { return std::clamp(e_deg, -48.5, 45.0) / 20.0; }

/// ln of the gap between measured rows i and i + 1 over 1.5 degrees; of the nearest ones there are.
double log_gap(const Run& run, int i) {
  const int above = std::clamp(i, 0, run.measured_m.rows - 2);
  return std::log((beam_deg(run, above) - beam_deg(run, above + 1)) / 1.5);
}

/// The bias of channel c in measured row y: psi(y) . B[.][c], B of 7 x c,
///   psi = ln gap above, ln gap below, e', e'^2, first, last, ln(column step / 0.35)
double beam_bias(const Run& run, const Array& b, int c, int y) {
  const double e = elevation_place(beam_deg(run, y));
  const std::array<double, 7> psi = {log_gap(run, y - 1),
                                     log_gap(run, y),
                                     e,
                                     e * e,
                                     y == 0 ? 1.0 : 0.0,
                                     y == run.measured_m.rows - 1 ? 1.0 : 0.0,
                                     std::log(360.0 / run.columns() / 0.35)};
  double bias = 0.0;
  for (std::size_t k = 0; k < psi.size(); ++k) bias += psi[k] * b.values[k * b.shape[1] + c];
  return bias;
}

/// Where a computed row is among the measured ones: 11 values for rows above their own measured
/// row, or for rows below it, the others 0 (nn/hqs/beam_parameters.h).
std::array<double, 22> row_place(const Run& run, int row) {
  const RowSelection rows = run.description.measured_rows;
  const int own = row / rows.stride;
  const bool above = row % rows.stride < rows.offset;
  const int other = above ? own - 1 : own + 1;
  const double e_deg = degrees(run.description.sensor.beam_elevation_rad[row]);
  const double g = log_gap(run, above ? own - 1 : own);
  const double distance = std::fabs(e_deg - beam_deg(run, own)) / (1.5 * std::exp(g));
  const bool outside = other < 0 || other >= run.measured_m.rows;
  const double v = outside ? 0.0 : 2.0 * distance - 1.0;
  const double e = elevation_place(e_deg);
  std::array<double, 22> phi{};
  double* half = phi.data() + (above ? 0 : 11);
  for (int power = 0; power < 4; ++power) {
    half[power] = outside && power > 0 ? 0.0 : std::pow(v, power);
  }
  half[4] = g;
  half[5] = g * v;
  half[6] = e;
  half[7] = e * v;
  half[8] = e * e;
  half[9] = outside ? 1.0 : 0.0;
  half[10] = outside ? std::min(distance, 2.0) : 0.0;
  return phi;
}

/// The head for any beams: out[(o, j, x)][y] = (phi W)[(o, x)] . in[.][y] + (phi b)[(o, x)] for
/// output o, computed row j and column x of a tile. W: 22 x (7 x 4) x channels, b: 22 x (7 x 4).
Image head_of_rows(const Run& run, const Image& in, const Array& weight, const Array& bias) {
  const RowSelection rows = run.description.measured_rows;
  const int tile_columns = run.network["denoiser"]["tile_columns"];
  const auto of_pixel = static_cast<int>(weight.shape[1]) / tile_columns;
  const auto channels = static_cast<int>(weight.shape[2]);
  const int computed = rows.stride - 1;
  Image out = zeros(of_pixel * computed * tile_columns, in.dimension(1), in.dimension(2));
  for (int y = 0; y < in.dimension(1); ++y) {
    for (int j = 0; j < computed; ++j) {
      const auto phi = row_place(run, y * rows.stride + (j < rows.offset ? j : j + 1));
      for (int n = 0; n < of_pixel * tile_columns; ++n) {  // output o of column x: 4 o + x
        const int to = (n / tile_columns * computed + j) * tile_columns + n % tile_columns;
        for (int k = 0; k < 22; ++k) {
          const std::size_t array = static_cast<std::size_t>(k) * weight.shape[1] + n;
          for (int x = 0; x < in.dimension(2); ++x) {
            double sum = bias.values[array];
            for (int c = 0; c < channels; ++c) {
              sum += weight.values[array * channels + c] * in(c, y, x);
            }
            out(to, y, x) += phi[k] * sum;
          }
        }
      }
    }
  }
  return out;
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
  const bool any_beams = sizes.value("any_beams", false);
  Image encoded = convolved("encoder.0", input);
  for (int c = 0; c < encoded.dimension(0); ++c) {  // a bias of its own for each row
    for (int y = 0; y < encoded.dimension(1); ++y) {
      const double bias = any_beams
                              ? beam_bias(run, array("encoder.0.beam_bias"), c, y)
                              : array("encoder.0.row_bias").values[c * encoded.dimension(1) + y];
      for (int x = 0; x < encoded.dimension(2); ++x) encoded(c, y, x) += bias;
    }
  }
  encoded = named("encoder.0", activated(encoded, slope));
  Image x = named("encoder.1", activated(convolved("encoder.1", encoded, 2), slope));
  x = named("bottleneck.0", activated(convolved("bottleneck.0", x), slope));
  for (int block = 1; block <= blocks; ++block) {
    const std::string name = fmt::format("bottleneck.{}", block);
    x = named(name, activated(convolved(name, x) + x, slope));
  }
  x = transposed_convolution(x, array("decoder.0.weight"), array("decoder.0.bias"));
  x = named("decoder.0", activated(x + encoded, slope));
  if (any_beams) return head_of_rows(run, x, array("head.weight"), array("head.bias"));
  return convolved("head", x);
}

/// The share of a Laplace distribution of scale 1 around 0 below v.
double laplace_below(double v) {
  const double tail = 0.5 * std::exp(-std::fabs(v));
  return v > 0.0 ? 1.0 - tail : tail;
}

/// The result for one pixel. With outputs o, s(v) = 1 / (1 + e^-v) and y in ln of metres:
///   y1 = s(4 o0) above + (1 - s(4 o0)) h + o1      the mode on the side of the row above
///   y2 = s(4 o2) below + (1 - s(4 o2)) h + o3      the mode on the side of the row below
///   w  = s(4 o4)                                   probability of the first
///   scale = exp(-3.5 + 4 clamp(o5, -1/2, 1))       of both Laplace distributions
///   p  = s(4 o6)                                   probability of a return
/// With a memory each mode has an h of its own, start + g (M - start): W^2 scaled by an output,
///   g = W^2 e / (W^2 e + 1),  e = exp(4 clamp(o, -2, 2)),  o = o7 for the first, o8 for the second
struct Said {
  double mode_1, mode_2, weight_1, scale, probability;

  double chosen() const { return weight_1 >= 0.5 ? mode_1 : mode_2; }
  /// That there is a return, and within the tolerance of the chosen range.
  double confidence(double tolerance_m, double exponent) const {
    const double range_m = std::exp(std::clamp(chosen(), -5.0, 9.0));
    const double farther = std::log(1.0 + tolerance_m / range_m) / scale;
    const double nearer = -std::log(std::max(1.0 - tolerance_m / range_m, 1e-6)) / scale;
    const double other = weight_1 >= 0.5 ? mode_2 : mode_1;
    const double gap = (other - chosen()) / scale;
    const double weight = weight_1 >= 0.5 ? weight_1 : 1.0 - weight_1;
    const double of_chosen = laplace_below(farther) - laplace_below(-nearer);
    const double of_other = laplace_below(farther - gap) - laplace_below(-nearer - gap);
    return std::pow(probability * (weight * of_chosen + (1.0 - weight) * of_other), exponent);
  }
};

}  // namespace

void run_du_mix(Run& run) {
  const int tile_rows = run.network["denoiser"]["tile_rows"];
  const int tile_columns = run.network["denoiser"]["tile_columns"];
  const RowSelection rows = run.description.measured_rows;
  const Measured m = measured(run);
  // Start, linear in 1 / range.
  Image start = zeros(1, run.rows(), run.columns());
  for (int y = 0; y < run.rows(); ++y) {
    const Between at = between(run, y);
    const double down = part_down(run, y, at);
    for (int x = 0; x < run.columns(); ++x) {
      start(0, y, x) =
          -std::log((1.0 - down) / m.filled(0, at.above, x) + down / m.filled(0, at.below, x));
    }
  }
  // 10a with b -> 0: H = ln L where a pixel was measured, otherwise the start, drawn towards what
  // is recalled: (W^2 M + start) / (W^2 + 1).
  const Recalled memory = recalled(run);
  Image h = start;
  for (int y = 0; y < run.rows(); ++y) {
    for (int x = 0; x < run.columns() && !run.is_measured(y); ++x) {
      h(0, y, x) += memory.share(0, y, x) * (memory.m(0, y, x) - start(0, y, x));
    }
  }
  /// ln to metres; a measured pixel as it was measured.
  const auto add_metres = [&](const std::string& name, Image image) {
    for (int y = 0; y < run.rows(); ++y) {
      for (int x = 0; x < run.columns(); ++x) {
        image(0, y, x) = run.is_measured(y) ? run.measured_m.at((y - rows.offset) / rows.stride, x)
                                            : std::exp(image(0, y, x));
      }
    }
    run.add(name, image, "m");
  };
  add_metres("start", start);
  add_metres("layers.0.h", h);
  const Image outputs =
      outputs_of(run, input_of(run, m, start, memory, h, tile_rows, tile_columns));
  const Image empty = zeros(1, run.rows(), run.columns());
  Image mode_1 = empty, mode_2 = empty, weight_1 = empty, scale = empty, probability = empty;
  Image z = h;
  Image confidence = empty;
  const int pixels = (tile_rows - 1) * tile_columns;  // of a tile that are computed
  for (int y = 0; y < run.rows(); ++y) {
    const int in_tile = y % tile_rows;
    const int tile = y / tile_rows;
    const Between at = between(run, y);
    for (int x = 0; x < run.columns(); ++x) {
      if (run.is_measured(y)) {
        probability(0, y, x) = confidence(0, y, x) = m.valid(0, tile, x);
        continue;
      }
      const int pixel =
          (in_tile < rows.offset ? in_tile : in_tile - 1) * tile_columns + x % tile_columns;
      const auto o = [&](int group) {
        return outputs(group * pixels + pixel, tile, x / tile_columns);
      };
      const double above = std::log(m.filled(0, at.above, x));
      const double below = std::log(m.filled(0, at.below, x));
      const auto middle = [&](int group) {
        const double share = memory.share(0, y, x);
        if (share == 0.0) return h(0, y, x);
        const double scaled =
            share / (1.0 - share) * std::exp(4.0 * std::clamp(o(group), -2.0, 2.0));
        const double from = start(0, y, x);
        return from + scaled / (scaled + 1.0) * (memory.m(0, y, x) - from);
      };
      const double first = middle(7);
      const double second = middle(8);
      const Said said{.mode_1 = first + logistic(4.0 * o(0)) * (above - first) + o(1),
                      .mode_2 = second + logistic(4.0 * o(2)) * (below - second) + o(3),
                      .weight_1 = logistic(4.0 * o(4)),
                      .scale = std::exp(-3.5 + 4.0 * std::clamp(o(5), -0.5, 1.0)),
                      .probability = logistic(4.0 * o(6))};
      mode_1(0, y, x) = said.mode_1;
      mode_2(0, y, x) = said.mode_2;
      weight_1(0, y, x) = said.weight_1;
      scale(0, y, x) = said.scale;
      probability(0, y, x) = said.probability;
      z(0, y, x) = said.chosen();                      // 10b: the likelier mode
      const double range_m = std::exp(said.chosen());  // beyond the sensor's limits is no return
      const bool seen = range_m >= run.description.sensor.min_range_m &&
                        range_m <= run.description.sensor.max_range_m;
      confidence(0, y, x) = seen ? said.confidence(0.5, run.description.confidence_exponent) : 0.0;
    }
  }
  add_metres("mode_1", mode_1);
  add_metres("mode_2", mode_2);
  run.add("weight_1", weight_1);
  run.add("scale", scale);
  run.add("probability", probability);
  add_metres("layers.0.z", z);
  run.add("confidence", confidence);
}

}  // namespace hqslam::nn::reference
