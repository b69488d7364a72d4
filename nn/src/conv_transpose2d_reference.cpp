#include "conv_transpose2d.h"
#include "reference_index.h"

// The definition, loop by loop: what the fast kernels are tested against. `for_each_tap` of the
// output tensor lists the output pixels that input pixel (y, x) adds to.
namespace hqslam::nn {

void conv_transpose2d_reference(const ConvolutionShape& shape, std::span<const float> weight,
                                std::span<const float> bias, const Tensor& input, Tensor& output) {
  for (int o = 0; o < output.channels(); ++o) {
    for (int y = 0; y < output.rows(); ++y) {
      for (int x = 0; x < output.columns(); ++x) output.at(o, y, x) = bias.empty() ? 0.0F : bias[o];
    }
  }
  for (int i = 0; i < input.channels(); ++i) {
    for (int y = 0; y < input.rows(); ++y) {
      for (int x = 0; x < input.columns(); ++x) {
        for_each_tap(shape, output, y, x, [&](int o, int r, int c, int row, int column) {
          output.at(o, row, column) +=
              weight[weight_index(shape, i, shape.output_channels, o, r, c)] * input.at(i, y, x);
        });
      }
    }
  }
  output.fill_borders();
}

void conv_transpose2d_backward_reference(const ConvolutionShape& shape,
                                         std::span<const float> weight, const Tensor& input,
                                         const Tensor& d_output, Tensor& d_input,
                                         std::span<float> d_weight, std::span<float> d_bias) {
  d_input.set_zero();
  for (int i = 0; i < input.channels(); ++i) {
    for (int y = 0; y < input.rows(); ++y) {
      for (int x = 0; x < input.columns(); ++x) {
        for_each_tap(shape, d_output, y, x, [&](int o, int r, int c, int row, int column) {
          const auto index = weight_index(shape, i, shape.output_channels, o, r, c);
          d_weight[index] += input.at(i, y, x) * d_output.at(o, row, column);
          d_input.at(i, y, x) += weight[index] * d_output.at(o, row, column);
        });
      }
    }
  }
  d_input.fill_borders();
  if (d_bias.empty()) return;
  for (int o = 0; o < d_output.channels(); ++o) {
    for (int y = 0; y < d_output.rows(); ++y) {
      for (int x = 0; x < d_output.columns(); ++x) d_bias[o] += d_output.at(o, y, x);
    }
  }
}

}  // namespace hqslam::nn
