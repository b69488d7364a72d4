#include "du_mix.h"

#include <cmath>

namespace hqslam::nn::reference {
namespace {

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

/// The start, linear in 1 / range between the measured rows; ln of metres.
Image start_of(const Run& run, const Measured& m) {
  Image start = zeros(1, run.rows(), run.columns());
  for (int y = 0; y < run.rows(); ++y) {
    const Between at = between(run, y);
    const double down = part_down(run, y, at);
    for (int x = 0; x < run.columns(); ++x) {
      start(0, y, x) =
          -std::log((1.0 - down) / m.filled(0, at.above, x) + down / m.filled(0, at.below, x));
    }
  }
  return start;
}

/// 10a with b -> 0: H = ln L where a pixel was measured, otherwise the start, drawn towards what is
/// recalled: (W^2 M + start) / (W^2 + 1).
Image h_of(const Run& run, const Image& start, const Recalled& recalled) {
  Image h = start;
  for (int y = 0; y < run.rows(); ++y) {
    for (int x = 0; x < run.columns() && !run.is_measured(y); ++x) {
      h(0, y, x) += recalled.share(0, y, x) * (recalled.m(0, y, x) - start(0, y, x));
    }
  }
  return h;
}

/// ln to metres; a measured pixel as it was measured.
void add_metres(Run& run, const std::string& name, Image image) {
  const RowSelection rows = run.description.measured_rows;
  for (int y = 0; y < run.rows(); ++y) {
    for (int x = 0; x < run.columns(); ++x) {
      image(0, y, x) = run.is_measured(y) ? run.measured_m.at((y - rows.offset) / rows.stride, x)
                                          : std::exp(image(0, y, x));
    }
  }
  run.add(name, image, "m");
}

/// 10b for pixel (y, x) of a row that is computed; outputs: du_mix_prior().
Modes modes_at(const Run& run, const MixImages& images, const Image& outputs, int y, int x) {
  const RowSelection rows = run.description.measured_rows;
  const int tile_columns = run.network["denoiser"]["tile_columns"];
  const int in_tile = y % rows.stride;
  const int pixels = (rows.stride - 1) * tile_columns;  // of a tile that are computed
  const int pixel =
      (in_tile < rows.offset ? in_tile : in_tile - 1) * tile_columns + x % tile_columns;
  std::vector<double> o;
  for (int channel = pixel; channel < outputs.dimension(0); channel += pixels) {
    o.push_back(outputs(channel, y / rows.stride, x / tile_columns));
  }
  const Between at = between(run, y);
  const Image& filled = images.measured.filled;
  return modes_of({.above = std::log(filled(0, at.above, x)),
                   .below = std::log(filled(0, at.below, x)),
                   .start = images.start(0, y, x),
                   .h = images.h(0, y, x),
                   .recalled = images.recalled.m(0, y, x),
                   .recalled_share = images.recalled.share(0, y, x)},
                  o);
}

}  // namespace

void run_du_mix(Run& run) {
  MixImages images{measured(run), recalled(run), {}, {}};
  images.start = start_of(run, images.measured);
  images.h = h_of(run, images.start, images.recalled);
  add_metres(run, "start", images.start);
  add_metres(run, "layers.0.h", images.h);
  const Image outputs = du_mix_prior(run, images);
  const Image empty = zeros(1, run.rows(), run.columns());
  Image mode_1 = empty, mode_2 = empty, weight_1 = empty, scale = empty, probability = empty;
  Image z = images.h;
  Image confidence = empty;
  const SensorModel& sensor = run.description.sensor;
  for (int y = 0; y < run.rows(); ++y) {
    for (int x = 0; x < run.columns(); ++x) {
      if (run.is_measured(y)) {
        const int row = y / run.description.measured_rows.stride;
        probability(0, y, x) = confidence(0, y, x) = images.measured.valid(0, row, x);
        continue;
      }
      const Modes modes = modes_at(run, images, outputs, y, x);
      mode_1(0, y, x) = modes.mode_1;
      mode_2(0, y, x) = modes.mode_2;
      weight_1(0, y, x) = modes.weight_1;
      scale(0, y, x) = modes.scale;
      probability(0, y, x) = modes.probability;
      z(0, y, x) = modes.chosen();
      const double range_m = std::exp(modes.chosen());  // beyond the sensor's limits is no return
      const bool seen = range_m >= sensor.min_range_m && range_m <= sensor.max_range_m;
      confidence(0, y, x) = seen ? modes.confidence(0.5, run.description.confidence_exponent) : 0.0;
    }
  }
  add_metres(run, "mode_1", mode_1);
  add_metres(run, "mode_2", mode_2);
  run.add("weight_1", weight_1);
  run.add("scale", scale);
  run.add("probability", probability);
  add_metres(run, "layers.0.z", z);
  run.add("confidence", confidence);
}

}  // namespace hqslam::nn::reference
