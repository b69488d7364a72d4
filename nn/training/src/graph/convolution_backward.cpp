#include "layer_backward.h"

namespace hqslam::nn {
namespace {

/// In 16 sums side by side: one alone would wait for each addition.
float sum_of(const float* values, int count) {
  constexpr int kSums = 16;
  float sums[kSums] = {};
  int first = 0;
  for (; first + kSums <= count; first += kSums) {
#pragma omp simd
    for (int i = 0; i < kSums; ++i) sums[i] += values[first + i];
  }
  for (; first < count; ++first) sums[0] += values[first];
  float sum = 0.0F;
  for (const float part : sums) sum += part;
  return sum;
}

/// d_bias[c] += the sum over channel c of d_output; nothing for an empty d_bias.
void add_bias_gradient(const Tensor& d_output, std::span<float> d_bias) {
  if (d_bias.empty()) return;
  for (int channel = 0; channel < d_output.channels(); ++channel) {
    for (int y = 0; y < d_output.rows(); ++y) {
      d_bias[channel] += sum_of(d_output.row(channel, y), d_output.columns());
    }
  }
}

}  // namespace

ConvolutionBackward::ConvolutionBackward(ConvolutionLayer& layer, const Engine& engine)
    : layer_(layer) {
  if (layer.winograd() == nullptr) return;
  adjoint_.emplace(adjoint_of(layer.shape()), layer.output_shape().without_values(),
                   engine.instruction_set, engine.threads);
}

void ConvolutionBackward::set_parameters(std::span<const float> parameters) {
  if (adjoint_) adjoint_->set_weights(take(parameters, layer_.shape().weights()), true);
}

void ConvolutionBackward::forward_batch(std::span<const LayerPass> batch) {
  for (const LayerPass& pass : batch) layer_.forward(pass);
}

void ConvolutionBackward::backward(std::span<const BackwardPass> batch,
                                   std::span<float> d_parameters) {
  if (layer_.options().row_weights) {
    for (const BackwardPass& pass : batch) backward_by_row(pass, d_parameters);
    return;
  }
  const ConvolutionShape& shape = layer_.shape();
  const TensorShape& output = layer_.output_shape();
  const std::span<float> d_weight = take(d_parameters, shape.weights());
  const std::span<float> d_bias = take(d_parameters, layer_.options().bias ? output.channels : 0);
  for (const BackwardPass& pass : batch) {
    if (layer_.winograd() != nullptr) {
      layer_.winograd()->add_weight_gradient(*pass.input, *pass.d_output, d_weight);
    } else {
      const Tensor& narrow = shape.transposed ? *pass.input : *pass.d_output;
      const Tensor& wide = shape.transposed ? *pass.d_output : *pass.input;
      layer_.strided().add_weight_gradient(narrow, 0, wide, d_weight, layer_.scratch());
    }
    add_bias_gradient(*pass.d_output, d_bias);
    for (int i = 0; i < std::ssize(d_parameters); ++i) {  // of the rows' biases
      const float* values = pass.d_output->row(i / output.rows, i % output.rows);
      float sum = 0.0F;
      for (int x = 0; x < output.columns; ++x) sum += values[x];
      d_parameters[i] += sum;
    }
    if (pass.d_second != nullptr) add_channels(*pass.d_output, 0, *pass.d_second);
    backward_input(*pass.d_output, pass.end, *pass.d_input);
  }
}

/// Of a layer with weights for each row.
void ConvolutionBackward::backward_by_row(const BackwardPass& pass, std::span<float> d_parameters) {
  const TensorShape& output = layer_.output_shape();
  const std::int64_t weights = layer_.shape().weights();
  const std::span<float> d_weight = take(d_parameters, weights * output.rows);
  Tensor d_row(output.channels, 1, output.columns, output.padding, 0);
  for (int row = 0; row < output.rows; ++row) {
    for (int channel = 0; channel < output.channels; ++channel) {
      std::copy_n(pass.d_output->row(channel, row), output.columns, d_row.row(channel, 0));
      d_row.fill_border(channel, 0);
    }
    layer_.strided(row).add_weight_gradient(
        d_row, row, *pass.input, d_weight.subspan(row * weights, weights), layer_.scratch());
    add_bias_gradient(d_row, take(d_parameters, output.channels));
    layer_.strided(row).scatter_rows(d_row, row, pass.end, *pass.d_input);
  }
}

void ConvolutionBackward::backward_input(const Tensor& d_output, const LayerEnd& end,
                                         Tensor& d_input) {
  if (adjoint_) {
    adjoint_->forward(d_output, nullptr, end, d_input);
  } else if (layer_.shape().transposed) {
    layer_.strided().gather(d_output, nullptr, end, d_input, layer_.scratch());
  } else {
    layer_.strided().scatter(d_output, nullptr, end, d_input, layer_.scratch());
  }
}

void ConvolutionBackward::backward_rows(const Tensor& input, int first_row, const Tensor& d_output,
                                        const LayerEnd& end, Tensor& d_input,
                                        std::span<float> d_parameters) {
  layer_.require_single_rows();
  const std::span<float> d_weight = take(d_parameters, layer_.shape().weights());
  layer_.strided().add_weight_gradient(d_output, first_row, input, d_weight, layer_.scratch());
  add_bias_gradient(d_output, d_parameters);
  layer_.strided().scatter_rows(d_output, first_row, end, d_input);
}

}  // namespace hqslam::nn
