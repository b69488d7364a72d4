#include <algorithm>
#include <array>
#include <cmath>

#include "du_mix.h"
#include "hqslam/core/angles.h"

namespace hqslam::nn::reference {
namespace {

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

}  // namespace

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

}  // namespace hqslam::nn::reference
