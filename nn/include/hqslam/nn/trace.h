#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unsupported/Eigen/CXX11/Tensor>
#include <vector>

#include "hqslam/core/range_image.h"
#include "hqslam/core/sensor_model.h"

namespace hqslam::nn {

/// An inner tensor of a network: channels x rows x columns.
struct TracedTensor {
  /// DontAlign: Eigen's aligned memory is freed in a way that depends on the caller's -m flags,
  /// which need not be the library's; memory that need not be aligned is malloc's everywhere.
  using Values = Eigen::Tensor<float, 3, Eigen::RowMajor | Eigen::DontAlign>;

  std::string name;  ///< "layers.2.encoder.0"
  std::string unit;  ///< "m", then 0 = no return; empty: none
  Values values;

  int channels() const { return static_cast<int>(values.dimension(0)); }
  int rows() const { return static_cast<int>(values.dimension(1)); }
  int columns() const { return static_cast<int>(values.dimension(2)); }
  /// All values: channel by channel, row by row.
  std::span<const float> all() const {
    return {values.data(), static_cast<std::size_t>(values.size())};
  }
};

/// What a network made of one scan: every inner tensor by its name. Images are as the sensor's
/// (rows x columns of pixels), features on the grid of their convolution. Layers count from 0.
///
/// All networks of eq. 10: `measured` (the measured rows), `start` (Z and Y before layer 0),
/// `layers.k.h`, `layers.k.z`, and between them what the convolutions give under the names of their
/// weights (`layers.k.encoder.0`), after the activation.
/// DU-OR: `layers.k.choice.above`, `.below`, `.here`, `.nothing` (weights of what a pixel may be),
/// `layers.k.choice.correction` (m), `layers.k.memory`, `layers.k.rejected` (1: by the filter),
/// `layers.k.y`. DU-OR and Simple DU: `layers.k.penalty` (b).
/// DU-Mix: `mode_1`, `mode_2` (m), `weight_1` (of mode 1), `scale` (of both, in ln of the range),
/// `probability` (of a return). With a memory also `recalled` (M, m) and `recalled_weight` (W^2),
/// where anything is recalled.
/// From SuperResolver: `rejected` (by the filter at the end), `confidence` (before pixels
/// with too little of it are emptied), `result`.
class Trace {
 public:
  void add(TracedTensor tensor) { tensors_.push_back(std::move(tensor)); }
  /// In the order in which the network computes them.
  const std::vector<TracedTensor>& tensors() const { return tensors_; }
  bool has(std::string_view name) const { return find(name) != nullptr; }
  /// Throws Error, which gives the nearest names, if there is none of this name.
  const TracedTensor& tensor(std::string_view name) const;
  /// A tensor of one channel as an image. Throws Error.
  RangeImage image(std::string_view name) const;

 private:
  const TracedTensor* find(std::string_view name) const;

  std::vector<TracedTensor> tensors_;
};

/// An image as a tensor of one channel.
TracedTensor traced_image(std::string name, const RangeImage& image, std::string unit = "m");

}  // namespace hqslam::nn
