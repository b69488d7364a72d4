#include "convolution_layer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

ConvolutionShape shape_of(const ConvolutionOptions& o, int input_channels) {
  return {.input_channels = input_channels,
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

ConvolutionShape adjoint_of(ConvolutionShape shape) {
  std::swap(shape.input_channels, shape.output_channels);
  return shape;
}

kernels::StridedConvolution strided(const ConvolutionShape& shape, const Tensor& input,
                                    const Tensor& output, InstructionSet instruction_set) {
  return shape.transposed
             ? kernels::StridedConvolution(adjoint_of(shape), input, output, instruction_set)
             : kernels::StridedConvolution(shape, output, input, instruction_set);
}

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

ConvolutionLayer::ConvolutionLayer(const ConvolutionOptions& options, const TensorShape& input,
                                   const Engine& engine)
    : ConvolutionLayer(options, input.without_values(), output_of(options, input).without_values(),
                       engine) {}

ConvolutionLayer::ConvolutionLayer(const ConvolutionOptions& options, const Tensor& input,
                                   const Tensor& output, const Engine& engine)
    : Layer(shape_of(output)),
      options_(options),
      shape_(shape_of(options, input.channels())),
      input_(shape_of(input)),
      convolution_(strided(shape_, input, output, engine.instruction_set)),
      threads_(engine.threads) {
  if (options.row_bias) row_bias_ = output_.make();
  if (shape_.transposed || !kernels::WinogradConvolution::suits(shape_, input)) return;
  winograd_.emplace(shape_, input, engine.instruction_set, engine.threads);
  adjoint_.emplace(adjoint_of(shape_), output, engine.instruction_set, engine.threads);
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
  check_parameters(parameters, parameter_shapes());
  const std::span<const float> weight = take(parameters, shape_.weights());
  if (winograd_) {
    winograd_->set_weights(weight);
    weight_.assign(weight.begin(), weight.end());
    adjoint_is_stale_ = true;
  } else {
    convolution_.set_weights(weight);
    if (scratch_.rows.empty()) scratch_ = convolution_.make_scratch(threads_);
  }
  const std::span<const float> bias = take(parameters, options_.bias ? output_.channels : 0);
  bias_.assign(bias.begin(), bias.end());
  bias_.resize(kernels::whole_blocks(output_.channels));
  if (!options_.row_bias) return;
  for (int channel = 0; channel < output_.channels; ++channel) {
    for (int row = 0; row < output_.rows; ++row) {
      std::fill_n(row_bias_.row(channel, row), output_.columns, take(parameters, 1).front());
    }
  }
}

void ConvolutionLayer::forward(const LayerPass& pass) {
  const LayerEnd end{options_.negative_slope, options_.row_bias ? &row_bias_ : pass.second};
  if (winograd_) {
    winograd_->forward(*pass.input, bias_.data(), end, *pass.output);
  } else if (shape_.transposed) {
    convolution_.scatter(*pass.input, bias_.data(), end, *pass.output, scratch_);
  } else {
    convolution_.gather(*pass.input, bias_.data(), end, *pass.output, scratch_);
  }
}

/// Throws Error unless single rows can be computed by themselves.
void ConvolutionLayer::require_single_rows() const {
  if (shape_.column_stride() == 1 && shape_.kernel_rows == 1) return;
  throw Error("conv2d: single rows with stride {} and {} kernel rows, expected 1, 1",
              shape_.column_stride(), shape_.kernel_rows);
}

void ConvolutionLayer::forward_row(const Tensor& input, int row, float* output,
                                   std::int64_t channel_stride) const {
  require_single_rows();
  convolution_.gather_row(input, bias_.data(), row, output, channel_stride);
}

void ConvolutionLayer::backward(std::span<const BackwardPass> batch,
                                std::span<float> d_parameters) {
  const std::span<float> d_weight = take(d_parameters, shape_.weights());
  const std::span<float> d_bias = take(d_parameters, options_.bias ? output_.channels : 0);
  for (const BackwardPass& pass : batch) {
    if (winograd_) {
      winograd_->add_weight_gradient(*pass.input, *pass.d_output, d_weight);
    } else {
      const Tensor& narrow = shape_.transposed ? *pass.input : *pass.d_output;
      const Tensor& wide = shape_.transposed ? *pass.d_output : *pass.input;
      convolution_.add_weight_gradient(narrow, 0, wide, d_weight, scratch_);
    }
    add_bias_gradient(*pass.d_output, d_bias);
    for (int i = 0; i < std::ssize(d_parameters); ++i) {  // of the rows' biases
      const float* values = pass.d_output->row(i / output_.rows, i % output_.rows);
      float sum = 0.0F;
      for (int x = 0; x < output_.columns; ++x) sum += values[x];
      d_parameters[i] += sum;
    }
    if (pass.d_second != nullptr) add_channels(*pass.d_output, 0, *pass.d_second);
    backward_input(*pass.d_output, pass.end, *pass.d_input);
  }
}

void ConvolutionLayer::backward_input(const Tensor& d_output, const LayerEnd& end,
                                      Tensor& d_input) {
  if (winograd_) {
    if (adjoint_is_stale_) adjoint_->set_weights(weight_, true);  // only who trains needs these
    adjoint_is_stale_ = false;
    adjoint_->forward(d_output, nullptr, end, d_input);
  } else if (shape_.transposed) {
    convolution_.gather(d_output, nullptr, end, d_input, scratch_);
  } else {
    convolution_.scatter(d_output, nullptr, end, d_input, scratch_);
  }
}

void ConvolutionLayer::backward_rows(const Tensor& input, int first_row, const Tensor& d_output,
                                     const LayerEnd& end, Tensor& d_input,
                                     std::span<float> d_parameters) {
  require_single_rows();
  const std::span<float> d_weight = take(d_parameters, shape_.weights());
  convolution_.add_weight_gradient(d_output, first_row, input, d_weight, scratch_);
  add_bias_gradient(d_output, d_parameters);
  convolution_.scatter_rows(d_output, first_row, end, d_input);
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
