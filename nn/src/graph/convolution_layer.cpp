#include "convolution_layer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tensor_sums.h"

namespace hqslam::nn {
namespace {

ConvolutionShape shape_of(const ConvolutionOptions& o, const TensorShape& input) {
  return {.input_channels = input.channels,
          .output_channels = o.channels,
          .kernel_rows = o.kernel.rows,
          .kernel_columns = o.kernel.columns,
          .stride = o.stride.rows,
          .padding_rows = o.padding.rows,
          .padding_columns = o.padding.columns,
          .stride_columns = o.stride.columns,
          .transposed = o.transposed};
}

TensorShape output_of(const ConvolutionOptions& o, const TensorShape& input) {
  if (o.transposed) {
    return {o.channels, input.rows * o.stride.rows, input.columns * o.stride.columns,
            input.padding};
  }
  const int columns =
      input.padding == ColumnPadding::kCircular
          ? input.columns / o.stride.columns
          : convolved_size(input.columns, o.kernel.columns, o.stride.columns, o.padding.columns);
  return {o.channels, convolved_size(input.rows, o.kernel.rows, o.stride.rows, o.padding.rows),
          columns, input.padding};
}

}  // namespace

ConvolutionLayer::ConvolutionLayer(const ConvolutionOptions& options, const TensorShape& input,
                                   const Engine& engine)
    : Layer(output_of(options, input)),
      options_(options),
      shape_(shape_of(options, input)),
      input_(input),
      layer_(shape_, input.make(), output_.make(), engine.instruction_set, engine.threads) {
  if (options.row_bias) row_bias_ = output_.make();
}

std::int64_t ConvolutionLayer::multiply_adds() const {
  const TensorShape& pixels = options_.transposed ? input_ : output_;
  return shape_.weights() * pixels.rows * pixels.columns;
}

std::vector<ParameterShape> ConvolutionLayer::parameter_shapes() const {
  int first = shape_.output_channels;
  int second = shape_.input_channels;
  if (options_.transposed) std::swap(first, second);
  std::vector<ParameterShape> shapes{
      {"weight", {first, second, shape_.kernel_rows, shape_.kernel_columns}}};
  if (options_.linear) shapes.front().shape.resize(2);
  if (options_.bias) shapes.push_back({"bias", {output_.channels}});
  if (options_.row_bias) shapes.push_back({"row_bias", {output_.channels, output_.rows}});
  return shapes;
}

void ConvolutionLayer::add_initial_parameters(UniformStart& start,
                                              std::vector<float>& parameters) const {
  // PyTorch counts the fan-in of both kinds of convolution in the second extent.
  const int second = options_.transposed ? shape_.output_channels : shape_.input_channels;
  const auto fan_in = static_cast<float>(second * shape_.kernel_rows * shape_.kernel_columns);
  start.add(shape_.weights(),
            options_.start_limit.value_or(options_.start_scale / std::sqrt(fan_in)), parameters);
  if (options_.bias && options_.start_limit) {
    parameters.insert(parameters.end(), output_.channels, options_.start_bias);
  } else if (options_.bias) {
    start.add(output_.channels, 0.1F * options_.start_scale, parameters);
  }
  if (options_.row_bias) {
    parameters.insert(parameters.end(), static_cast<std::size_t>(output_.channels) * output_.rows,
                      0.0F);
  }
}

void ConvolutionLayer::set_parameters(std::span<const float> parameters) {
  const std::span<const float> weight = take(parameters, shape_.weights());
  layer_.set_parameters(weight, take(parameters, options_.bias ? output_.channels : 0));
  if (!options_.row_bias) return;
  for (int channel = 0; channel < output_.channels; ++channel) {
    for (int row = 0; row < output_.rows; ++row) {
      std::fill_n(row_bias_.row(channel, row), output_.columns, take(parameters, 1).front());
    }
  }
}

void ConvolutionLayer::forward(const LayerPass& pass) {
  layer_.forward(*pass.input,
                 {options_.negative_slope, options_.row_bias ? &row_bias_ : pass.second},
                 *pass.output);
}

void ConvolutionLayer::backward(std::span<const BackwardPass> batch,
                                std::span<float> d_parameters) {
  const std::span<float> d_weight = take(d_parameters, shape_.weights());
  const std::span<float> d_bias = take(d_parameters, options_.bias ? output_.channels : 0);
  for (const BackwardPass& pass : batch) {
    layer_.backward_parameters(*pass.input, *pass.d_output, d_weight, d_bias);
    for (int i = 0; i < std::ssize(d_parameters); ++i) {  // of the rows' biases
      const float* values = pass.d_output->row(i / output_.rows, i % output_.rows);
      float sum = 0.0F;
      for (int x = 0; x < output_.columns; ++x) sum += values[x];
      d_parameters[i] += sum;
    }
    if (pass.d_second != nullptr) add_channels(*pass.d_output, 0, *pass.d_second);
    layer_.backward_input(*pass.d_output, pass.end, *pass.d_input);
  }
}

void ConvolutionLayer::backward_rows(const Tensor& input, int first_row, const Tensor& d_output,
                                     const LayerEnd& end, Tensor& d_input,
                                     std::span<float> d_parameters) {
  const std::span<float> d_weight = take(d_parameters, shape_.weights());
  layer_.backward_rows(input, first_row, d_output, end, d_input, d_weight, d_parameters);
}

std::function<void()> ConvolutionLayer::reference(const LayerPass& pass) const {
  if (options_.transposed) return {};
  const std::vector<float> weight(static_cast<std::size_t>(shape_.weights()), 0.5F);
  return [this, weight, input = pass.input] {
    Tensor result = output_.make();
    conv2d_reference(shape_, weight, {}, *input, result);
  };
}

}  // namespace hqslam::nn
