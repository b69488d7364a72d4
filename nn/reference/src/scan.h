#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/nn/network_description.h"
#include "hqslam/nn/reference/reference.h"

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

/// One learned array: its shape in PyTorch's layout, its values row-major.
struct Array {
  std::vector<std::int64_t> shape;
  std::span<const double> values;
};

/// The learned arrays of a network by their names.
class Parameters {
 public:
  /// values: all arrays of parameter_shapes(description), one after the other. Throws Error for
  /// another number.
  Parameters(const NetworkDescription& description, std::span<const double> values);
  const Array& operator[](const std::string& name) const { return arrays_.at(name); }

 private:
  std::map<std::string, Array> arrays_;
};

/// What one run of the reference stands on, and what it writes down.
struct Run {
  const NetworkDescription& description;
  nlohmann::json network;  ///< the description as JSON: sizes of the layers
  Parameters parameters;
  const RangeImage& measured_m;
  const ReferenceOptions& options;
  ReferenceTrace trace;

  int rows() const { return description.sensor.rows(); }
  int columns() const { return measured_m.columns; }
  bool is_measured(int row) const { return description.measured_rows.contains(row); }
  /// image times `unit_m` under this name.
  void add(const std::string& name, const Image& image, const std::string& unit = "",
           double unit_m = 1.0);
};

/// The measured rows between which an image row lies, and how far down (0: at `above`, 1: at
/// `below`); beyond the outermost ones both are the outermost.
struct Between {
  int above = 0;
  int below = 0;
  double part_down = 0.0;
};
/// Counted in rows.
Between between(const Run& run, int row);

/// A convolution with an odd kernel, padded by half of it:
///   out[o][y][x] = bias[o] + sum over i, r, c of
///                  weight[o][i][r][c] in[i][stride y + r - kernel / 2][stride x + c - kernel / 2]
/// in: i x rows x columns. weight: o x i x kernel x kernel. bias: o; null: none.
/// Returns o x rows / stride x columns / stride.
Image convolution(const Image& in, const Array& weight, const Array* bias, int stride = 1);

/// Its adjoint for a kernel of 2 x 2 and a stride of 2: each pixel becomes four.
///   out[o][y][x] = bias[o] + sum over i of weight[i][o][y mod 2][x mod 2] in[i][y / 2][x / 2]
/// in: i x rows x columns. weight: i x o x 2 x 2. Returns o x 2 rows x 2 columns.
Image transposed_convolution(const Image& in, const Array& weight, const Array& bias);

/// max(v, slope v): slope 0 is ReLU.
Image activated(Image image, double slope);
/// Pixel by pixel, channel by channel.
Image sum(Image a, const Image& b);

/// An image cut into tiles: pixel (y, x) becomes channel (y mod tile rows) tile columns +
/// x mod tile columns of place (y / tile rows, x / tile columns).
/// image: 1 x rows x columns. Returns tile rows tile columns x rows / tile rows x ...
Image tiled(const Image& image, int tile_rows, int tile_columns);
/// The way back, from as many channels from `first` on.
Image untiled(const Image& tiles, int first, int tile_rows, int tile_columns);

/// Q: 1 where a pixel of H (1 x rows x columns, metres) belongs to a connected component of fewer
/// than min_pixels pixels and nothing measured supports it. Measured pixels are never rejected.
std::vector<std::uint8_t> outliers(const SensorModel& sensor, RowSelection measured_rows,
                                   const OutlierRemovalOptions& options, const Image& h_m);

/// DU-OR and Simple DU (hqs.cpp), DU-Mix (du_mix.cpp).
void run_hqs(Run& run);
void run_du_mix(Run& run);
/// The priors of the first two: Z = G(H), images in units of range_scale_m. DU-OR's hands memory
/// from layer to layer, and chooses between H and the measured ranges above and below.
Image du_or_prior(Run& run, int k, const Image& h, const Image& above, const Image& below,
                  Image& memory);
Image simple_du_prior(Run& run, int k, const Image& h);

}  // namespace hqslam::nn::reference
