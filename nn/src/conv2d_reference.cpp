#include "conv2d.h"
#include "reference_index.h"

// The definition, loop by loop: what the fast kernels are tested against.
namespace hqslam::nn {

void conv2d_reference(const ConvolutionShape& shape, std::span<const float> weight,
                      std::span<const float> bias, const Tensor& input, Tensor& output) {
  for (int o = 0; o < output.channels(); ++o) {
    for (int y = 0; y < output.rows(); ++y) {
      for (int x = 0; x < output.columns(); ++x) {
        double sum = bias.empty() ? 0.0 : bias[o];
        for_each_tap(shape, input, y, x, [&](int i, int r, int c, int row, int column) {
          sum +=
              static_cast<double>(weight[weight_index(shape, o, shape.input_channels, i, r, c)]) *
              input.at(i, row, column);
        });
        output.at(o, y, x) = static_cast<float>(sum);
      }
    }
  }
  output.fill_borders();
}

void conv2d_backward_reference(const ConvolutionShape& shape, std::span<const float> weight,
                               const Tensor& input, const Tensor& d_output, Tensor& d_input,
                               std::span<float> d_weight, std::span<float> d_bias) {
  d_input.set_zero();
  for (int o = 0; o < d_output.channels(); ++o) {
    for (int y = 0; y < d_output.rows(); ++y) {
      for (int x = 0; x < d_output.columns(); ++x) {
        const float gradient = d_output.at(o, y, x);
        if (!d_bias.empty()) d_bias[o] += gradient;
        for_each_tap(shape, input, y, x, [&](int i, int r, int c, int row, int column) {
          const auto index = weight_index(shape, o, shape.input_channels, i, r, c);
          d_weight[index] += gradient * input.at(i, row, column);
          d_input.at(i, row, column) += gradient * weight[index];
        });
      }
    }
  }
  d_input.fill_borders();
}

}  // namespace hqslam::nn
