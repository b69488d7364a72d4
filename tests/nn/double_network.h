#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "hqslam/core/range_image.h"
#include "small_network.h"

// The networks once more, in double precision and as plainly as their formulas: no tiles in memory,
// no borders, no vectors. The filter's decisions are given; without dropout.
namespace hqslam::nn::plain {

/// Channels x rows x columns; outside it is zero in rows, and zero or circular in columns.
struct Image {
  int channels;
  int rows;
  int columns;
  bool circular;
  std::vector<double> values;

  Image(int channels_, int rows_, int columns_, bool circular_)
      : channels(channels_),
        rows(rows_),
        columns(columns_),
        circular(circular_),
        values(static_cast<std::size_t>(channels_) * rows_ * columns_) {}
  double& at(int c, int y, int x) {
    return values[(static_cast<std::size_t>(c) * rows + y) * columns + x];
  }
  double at(int c, int y, int x) const {
    return values[(static_cast<std::size_t>(c) * rows + y) * columns + x];
  }
  double beyond(int c, int y, int x) const {
    if (circular) x = (x + columns) % columns;
    return y < 0 || y >= rows || x < 0 || x >= columns ? 0.0 : at(c, y, x);
  }
};

inline std::span<const double> take(std::span<const double>& parameters, int count) {
  const std::span<const double> front = parameters.first(count);
  parameters = parameters.subspan(count);
  return front;
}

inline Image convolved(const Image& in, int channels, int kernel, int stride, bool bias,
                       std::span<const double>& parameters) {
  const auto weight = take(parameters, channels * in.channels * kernel * kernel);
  const auto offset = take(parameters, bias ? channels : 0);
  Image out(channels, in.rows / stride, in.columns / stride, in.circular);
  for (int o = 0; o < channels; ++o) {
    for (int y = 0; y < out.rows; ++y) {
      for (int x = 0; x < out.columns; ++x) {
        double sum = bias ? offset[o] : 0.0;
        const double* w = &weight[o * in.channels * kernel * kernel];
        for (int i = 0; i < in.channels; ++i) {
          for (int r = 0; r < kernel; ++r) {
            for (int c = 0; c < kernel; ++c) {
              sum += *w++ * in.beyond(i, y * stride + r - kernel / 2, x * stride + c - kernel / 2);
            }
          }
        }
        out.at(o, y, x) = sum;
      }
    }
  }
  return out;
}

/// 2 x 2, stride 2: each pixel becomes four.
inline Image enlarged(const Image& in, int channels, std::span<const double>& parameters) {
  const auto weight = take(parameters, in.channels * channels * 4);
  const auto offset = take(parameters, channels);
  Image out(channels, 2 * in.rows, 2 * in.columns, in.circular);
  for (int o = 0; o < channels; ++o) {
    for (int y = 0; y < out.rows; ++y) {
      for (int x = 0; x < out.columns; ++x) {
        double sum = offset[o];
        for (int i = 0; i < in.channels; ++i) {
          sum += weight[(i * channels + o) * 4 + y % 2 * 2 + x % 2] * in.at(i, y / 2, x / 2);
        }
        out.at(o, y, x) = sum;
      }
    }
  }
  return out;
}

inline Image activated(Image image, double slope) {
  for (double& value : image.values) value = std::max(value, slope * value);
  return image;
}

/// Images in units of range_scale_m.
struct Start {
  Image above;
  Image below;
  Image linear;
};

inline Start start(const UnrolledPlan& d, const RangeImage& measured, bool circular) {
  const Image empty(1, d.sensor.rows(), measured.columns, circular);
  Start s{empty, empty, empty};
  for (int y = 0; y < empty.rows; ++y) {
    const double place = static_cast<double>(y - d.measured_rows.offset) / d.measured_rows.stride;
    const double inside = std::clamp(place, 0.0, measured.rows - 1.0);
    const int up = static_cast<int>(std::floor(inside));
    const int down = static_cast<int>(std::ceil(inside));
    const double part = inside - up;
    for (int x = 0; x < empty.columns; ++x) {
      const double u = measured.at(up, x) / static_cast<double>(d.range_scale_m);
      const double v = measured.at(down, x) / static_cast<double>(d.range_scale_m);
      s.above.at(0, y, x) = u;
      s.below.at(0, y, x) = v;
      const bool both = u > 0.0 && v > 0.0;
      s.linear.at(0, y, x) = both ? (1.0 - part) * u + part * v : (part < 0.5 ? u : v);
    }
  }
  return s;
}

/// H in; Z out. `memory` is replaced by the next layer's.
inline Image u_shaped(const UShapedDenoiserShape& shape, const Start& s, const Image& h,
                      Image& memory, std::span<const double>& parameters) {
  const int pixels = shape.tile.pixels();
  const auto channel = [&](int y, int x) {
    return y % shape.tile.rows * shape.tile.columns + x % shape.tile.columns;
  };
  Image input(pixels + shape.memory, memory.rows, memory.columns, true);
  for (int y = 0; y < h.rows; ++y) {
    for (int x = 0; x < h.columns; ++x) {
      input.at(channel(y, x), y / shape.tile.rows, x / shape.tile.columns) = h.at(0, y, x);
    }
  }
  std::copy_n(memory.values.begin(), shape.memory * memory.rows * memory.columns,
              input.values.end() - shape.memory * memory.rows * memory.columns);
  std::vector<Image> levels;
  for (std::size_t level = 0; level < shape.channels.size(); ++level) {
    levels.push_back(activated(convolved(level == 0 ? input : levels.back(), shape.channels[level],
                                         3, level == 0 ? 1 : 2, true, parameters),
                               shape.negative_slope));
  }
  Image up = activated(convolved(levels.back(), shape.channels.back(), 3, 1, true, parameters),
                       shape.negative_slope);
  for (std::size_t level = shape.channels.size() - 1; level-- > 0;) {
    up = enlarged(up, shape.channels[level], parameters);
    for (std::size_t i = 0; i < up.values.size(); ++i) up.values[i] += levels[level].values[i];
    up = activated(up, shape.negative_slope);
  }
  const Image output = convolved(up, 5 * pixels + shape.memory, 1, 1, true, parameters);
  std::copy(output.values.end() - shape.memory * memory.rows * memory.columns, output.values.end(),
            memory.values.begin());
  Image z = h;
  for (int y = 0; y < h.rows; ++y) {
    for (int x = 0; x < h.columns; ++x) {
      const auto score = [&](int group) {
        return output.at(group * pixels + channel(y, x), y / shape.tile.rows,
                         x / shape.tile.columns);
      };
      double weight[4];
      double sum = 0.0;
      for (int group = 0; group < 4; ++group) sum += weight[group] = std::exp(4.0 * score(group));
      z.at(0, y, x) = (weight[0] * s.above.at(0, y, x) + weight[1] * s.below.at(0, y, x) +
                       weight[2] * h.at(0, y, x)) /
                          sum +
                      score(4);
    }
  }
  return z;
}

/// What each layer's filter rejects, rows x columns.
using Masks = std::vector<std::vector<std::uint8_t>>;

/// Each layer's Z, rows x columns, in units of range_scale_m. `rejected`: the filter's decisions.
inline std::vector<std::vector<double>> layers_z(const UnrolledPlan& d,
                                                 std::span<const double> parameters,
                                                 const RangeImage& measured,
                                                 const Masks& rejected) {
  std::vector<std::vector<double>> all;
  const bool simple = d.simple();
  const bool z_alone = d.auxiliaries == Auxiliaries::kZ;
  const Start s = start(d, measured, !simple);
  const TileSize tile = d.u_shaped.tile;
  Image memory(std::max(1, d.u_shaped.memory), s.linear.rows / tile.rows,
               s.linear.columns / tile.columns, true);
  Image z = s.linear;
  if (d.start == nn::Start::kZero) std::fill(z.values.begin(), z.values.end(), 0.0);
  Image y = z;
  const std::span<const double> penalties = parameters.last(d.penalties());
  std::span<const double> next = parameters;
  for (int layer = 0; layer < d.layers; ++layer) {
    const double b = d.penalty == Penalty::kAlpha ? 0.5 / penalties[0] : std::exp(penalties[layer]);
    Image h = z;
    for (int row = 0; row < h.rows; ++row) {
      const int beyond = row - d.measured_rows.offset;
      const double observed = beyond >= 0 && beyond % d.measured_rows.stride == 0 ? 1.0 : 0.0;
      for (int x = 0; x < h.columns; ++x) {
        h.at(0, row, x) =
            (observed * s.below.at(0, row, x) + b * (z.at(0, row, x) + y.at(0, row, x))) /
            (observed + 2.0 * b);
      }
    }
    if (d.shared_weights) next = parameters;
    if (simple) {
      z = h;
      for (int i = 0; i < d.plain.convolutions; ++i) {
        const bool last = i + 1 == d.plain.convolutions;
        z = convolved(z, last ? 1 : d.plain.features, 3, 1, false, next);
        if (!last) z = activated(z, 0.0);
      }
    } else {
      z = u_shaped(d.u_shaped, s, h, memory, next);
    }
    y = z;
    if (!z_alone) {
      y = d.filtered == FilteredIterate::kH ? h : z;
      for (std::size_t i = 0; i < y.values.size(); ++i) {
        if (rejected[layer][i] == 0) continue;
        y.values[i] = d.rejected == RejectedPixel::kZero ? 0.0 : z.values[i];
      }
    }
    all.push_back(z.values);
  }
  return all;
}

}  // namespace hqslam::nn::plain
