#include "scan.h"

#include <algorithm>
#include <cmath>

#include "hqslam/core/error.h"

namespace hqslam::nn::reference {

Parameters::Parameters(const NetworkDescription& description, std::span<const double> values) {
  const std::vector<ParameterShape> shapes = parameter_shapes(description);
  if (std::ssize(values) != elements(shapes)) {
    throw Error("reference: {} parameters, expected {}", values.size(), elements(shapes));
  }
  for (const ParameterShape& shape : shapes) {
    const auto count = static_cast<std::size_t>(shape.elements());
    arrays_[shape.name] = {shape.shape, values.first(count)};
    values = values.subspan(count);
  }
}

void Run::add(const std::string& name, const Image& image, const std::string& unit, double unit_m) {
  std::vector<double> values = image.values;
  for (double& value : values) value *= unit_m;
  trace.tensors.push_back(
      {name, unit, image.channels, image.rows, image.columns, std::move(values)});
}

Between between(const Run& run, int row) {
  const RowSelection rows = run.description.measured_rows;
  const double place = static_cast<double>(row - rows.offset) / rows.stride;
  const double inside = std::clamp(place, 0.0, run.measured_m.rows - 1.0);
  const double above = std::floor(inside);
  return {static_cast<int>(above), static_cast<int>(std::ceil(inside)), inside - above};
}

Image convolution(const Image& in, const Array& weight, const Array* bias, int stride) {
  const auto outputs = static_cast<int>(weight.shape[0]);
  const auto kernel = static_cast<int>(weight.shape[2]);
  Image out(outputs, in.rows / stride, in.columns / stride, in.circular);
  for (int o = 0; o < outputs; ++o) {
    for (int y = 0; y < out.rows; ++y) {
      for (int x = 0; x < out.columns; ++x) {
        double value = bias == nullptr ? 0.0 : bias->values[o];
        const double* w =
            &weight.values[static_cast<std::size_t>(o) * in.channels * kernel * kernel];
        for (int i = 0; i < in.channels; ++i) {
          for (int r = 0; r < kernel; ++r) {
            for (int c = 0; c < kernel; ++c) {
              value +=
                  *w++ * in.beyond(i, stride * y + r - kernel / 2, stride * x + c - kernel / 2);
            }
          }
        }
        out.at(o, y, x) = value;
      }
    }
  }
  return out;
}

Image transposed_convolution(const Image& in, const Array& weight, const Array& bias) {
  const auto outputs = static_cast<int>(weight.shape[1]);
  Image out(outputs, 2 * in.rows, 2 * in.columns, in.circular);
  for (int o = 0; o < outputs; ++o) {
    for (int y = 0; y < out.rows; ++y) {
      for (int x = 0; x < out.columns; ++x) {
        double value = bias.values[o];
        for (int i = 0; i < in.channels; ++i) {
          const double w = weight.values[((i * outputs + o) * 2 + y % 2) * 2 + x % 2];
          value += w * in.at(i, y / 2, x / 2);
        }
        out.at(o, y, x) = value;
      }
    }
  }
  return out;
}

Image activated(Image image, double slope) {
  for (double& value : image.values) value = std::max(value, slope * value);
  return image;
}

Image sum(Image a, const Image& b) {
  for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] += b.values[i];
  return a;
}

Image tiled(const Image& image, int tile_rows, int tile_columns) {
  Image tiles(tile_rows * tile_columns, image.rows / tile_rows, image.columns / tile_columns);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.columns; ++x) {
      const int channel = y % tile_rows * tile_columns + x % tile_columns;
      tiles.at(channel, y / tile_rows, x / tile_columns) = image.at(0, y, x);
    }
  }
  return tiles;
}

Image untiled(const Image& tiles, int first, int tile_rows, int tile_columns) {
  Image image(1, tiles.rows * tile_rows, tiles.columns * tile_columns);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.columns; ++x) {
      const int channel = y % tile_rows * tile_columns + x % tile_columns;
      image.at(0, y, x) = tiles.at(first + channel, y / tile_rows, x / tile_columns);
    }
  }
  return image;
}

}  // namespace hqslam::nn::reference
