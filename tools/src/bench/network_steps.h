#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hqslam/nn/convolution_shape.h"
#include "hqslam/nn/hqs/network_description.h"
#include "hqslam/nn/tensor.h"

namespace hqslam::tools {

/// One convolution of a denoiser and the tensors it works on.
struct NetworkConvolution {
  std::string name;  ///< as in the weights file: "encoder.0"
  bool transposed = false;
  nn::ConvolutionShape shape;
  int input_rows = 0;
  int input_columns = 0;
  int output_rows = 0;
  int output_columns = 0;
  nn::ColumnPadding padding = nn::ColumnPadding::kCircular;

  nn::Tensor input() const { return {shape.input_channels, input_rows, input_columns, padding}; }
  nn::Tensor output() const {
    return {shape.output_channels, output_rows, output_columns, padding};
  }
  /// Of one call.
  std::int64_t multiply_adds() const;
};

/// The convolutions of one HQS layer in the order in which they run; of DU-Mix, of all layers.
std::vector<NetworkConvolution> convolutions_of(const nn::NetworkDescription& description);

}  // namespace hqslam::tools
