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

kernels::StridedConvolution strided_convolution(const ConvolutionShape& shape, const Tensor& input,
                                                const Tensor& output,
                                                InstructionSet instruction_set) {
  return shape.transposed
             ? kernels::StridedConvolution(adjoint_of(shape), input, output, instruction_set)
             : kernels::StridedConvolution(shape, output, input, instruction_set);
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
      convolution_(strided_convolution(shape_, input, output, engine.instruction_set)),
      threads_(engine.threads) {
  if (options.row_bias) row_bias_ = output_.make();
  if (options.row_weights) of_rows_.assign(output_.rows, convolution_);
  if (shape_.transposed || !kernels::WinogradConvolution::suits(shape_, input)) return;
  winograd_.emplace(shape_, input, engine.instruction_set, engine.threads);
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
  if (options_.row_weights) {
    return {{"weight", {output_.rows, first, second}}, {"bias", {output_.rows, first}}};
  }
  if (options_.bias) shapes.push_back({"bias", {output_.channels}});
  if (options_.row_bias) shapes.push_back({"row_bias", {output_.channels, output_.rows}});
  return shapes;
}

void ConvolutionLayer::add_initial_parameters(UniformStart& start,
                                              std::vector<float>& parameters) const {
  // PyTorch counts the fan-in of both kinds of convolution in the second extent.
  const int second = options_.transposed ? shape_.output_channels : shape_.input_channels;
  const auto fan_in = static_cast<float>(second * shape_.kernel_rows * shape_.kernel_columns);
  const int rows = options_.row_weights ? output_.rows : 1;
  start.add(rows * shape_.weights(),
            options_.start_limit.value_or(options_.start_scale / std::sqrt(fan_in)), parameters);
  if (options_.bias && options_.start_limit) {
    parameters.insert(parameters.end(), output_.channels, options_.start_bias);
  } else if (options_.bias) {
    start.add(rows * output_.channels, 0.1F * options_.start_scale, parameters);
  }
  if (options_.row_bias) {
    parameters.insert(parameters.end(), static_cast<std::size_t>(output_.channels) * output_.rows,
                      0.0F);
  }
}

void ConvolutionLayer::set_parameters(std::span<const float> parameters) {
  check_parameters(parameters, parameter_shapes());
  if (options_.row_weights) {
    set_row_parameters(parameters);
    return;
  }
  const std::span<const float> weight = take(parameters, shape_.weights());
  if (winograd_) {
    winograd_->set_weights(weight);
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

void ConvolutionLayer::set_row_parameters(std::span<const float> parameters) {
  for (kernels::StridedConvolution& row : of_rows_) {
    row.set_weights(take(parameters, shape_.weights()));
  }
  const std::size_t block = kernels::whole_blocks(output_.channels);
  bias_.assign(block * of_rows_.size(), 0.0F);
  for (std::size_t row = 0; row < of_rows_.size(); ++row) {
    std::ranges::copy(take(parameters, output_.channels), bias_.begin() + row * block);
  }
  if (scratch_.rows.empty()) scratch_ = convolution_.make_scratch(threads_);
}

void ConvolutionLayer::forward(const LayerPass& pass) {
  if (options_.row_weights) {
#pragma omp for schedule(static)
    for (int row = 0; row < output_.rows; ++row) {
      forward_row(*pass.input, row, pass.output->row(0, row), pass.output->channel_stride());
      for (int channel = 0; channel < output_.channels; ++channel) {
        pass.output->fill_border(channel, row);
      }
    }
    return;
  }
  const LayerEnd end{options_.negative_slope, options_.row_bias ? &row_bias_ : pass.second};
  if (winograd_) {
    winograd_->forward(*pass.input, bias_.data(), end, *pass.output);
  } else if (shape_.transposed) {
    convolution_.scatter(*pass.input, bias_.data(), end, *pass.output, scratch_);
  } else {
    convolution_.gather(*pass.input, bias_.data(), end, *pass.output, scratch_);
  }
}

void ConvolutionLayer::require_single_rows() const {
  if (shape_.column_stride() == 1 && shape_.kernel_rows == 1) return;
  throw Error("conv2d: single rows with stride {} and {} kernel rows, expected 1, 1",
              shape_.column_stride(), shape_.kernel_rows);
}

void ConvolutionLayer::forward_row(const Tensor& input, int row, float* output,
                                   std::int64_t channel_stride) const {
  require_single_rows();
  const std::size_t own = options_.row_weights ? row : 0;
  const float* bias = bias_.data() + own * kernels::whole_blocks(output_.channels);
  strided(row).gather_row(input, bias, row, output, channel_stride);
}

}  // namespace hqslam::nn
