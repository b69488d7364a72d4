#pragma once

#include <cstddef>
#include <vector>

namespace hqslam::nn::reference {

/// channels x rows x columns. Beyond its rows an image is 0; beyond its columns, too, or, as a scan
/// is a circle, it goes on with the other end.
struct Image {
  int channels = 1;
  int rows = 1;
  int columns = 1;
  bool circular = true;
  std::vector<double> values;

  Image(int channels_, int rows_, int columns_, bool circular_ = true)
      : channels(channels_),
        rows(rows_),
        columns(columns_),
        circular(circular_),
        values(static_cast<std::size_t>(channels_) * rows_ * columns_) {}

  double& at(int channel, int row, int column) {
    return values[(static_cast<std::size_t>(channel) * rows + row) * columns + column];
  }
  double at(int channel, int row, int column) const {
    return values[(static_cast<std::size_t>(channel) * rows + row) * columns + column];
  }
  double beyond(int channel, int row, int column) const {
    if (circular) column = (column + columns) % columns;
    const bool inside = row >= 0 && row < rows && column >= 0 && column < columns;
    return inside ? at(channel, row, column) : 0.0;
  }
};

}  // namespace hqslam::nn::reference
