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
