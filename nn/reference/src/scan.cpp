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
  trace.tensors.push_back({name, unit, image * unit_m});
}

Between between(const Run& run, int row) {
  const RowSelection rows = run.description.measured_rows;
  const double place = static_cast<double>(row - rows.offset) / rows.stride;
  const double inside = std::clamp(place, 0.0, run.measured_m.rows - 1.0);
  const double above = std::floor(inside);
  return {static_cast<int>(above), static_cast<int>(std::ceil(inside)), inside - above};
}

Image tiled(const Image& image, int tile_rows, int tile_columns) {
  const Eigen::Index rows = image.dimension(1);
  const Eigen::Index columns = image.dimension(2);
  Image tiles(tile_rows * tile_columns, rows / tile_rows, columns / tile_columns);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const int channel = y % tile_rows * tile_columns + x % tile_columns;
      tiles(channel, y / tile_rows, x / tile_columns) = image(0, y, x);
    }
  }
  return tiles;
}

Image untiled(const Image& tiles, int first, int tile_rows, int tile_columns) {
  Image image(1, tiles.dimension(1) * tile_rows, tiles.dimension(2) * tile_columns);
  for (int y = 0; y < image.dimension(1); ++y) {
    for (int x = 0; x < image.dimension(2); ++x) {
      const int channel = y % tile_rows * tile_columns + x % tile_columns;
      image(0, y, x) = tiles(first + channel, y / tile_rows, x / tile_columns);
    }
  }
  return image;
}

}  // namespace hqslam::nn::reference
