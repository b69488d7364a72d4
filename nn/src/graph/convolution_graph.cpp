#include "convolution_graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "../activation.h"
#include "hqslam/core/error.h"
#include "dropout.h"
#include "../parameters.h"

namespace hqslam::nn {
namespace {

/// The pixels of a step's result along one axis.
int size_after(const ConvolutionStep& step, int size) {
  if (step.transposed) return size * step.stride;
  if (size % step.stride != 0) {
    throw Error(fmt::format("network: {} pixels before '{}', expected a multiple of {}", size,
                            step.name, step.stride));
  }
  return size / step.stride;
}

/// Of what is not dropped, so that the mean stays.
float kept_scale(float dropout) { return 1.0F / (1.0F - dropout); }

void drop_out(std::uint64_t seed, float share, Tensor& values) {
  if (share == 0.0F) return;
#pragma omp for schedule(static)
  for (int channel = 0; channel < values.channels(); ++channel) {
    for (int y = 0; y < values.rows(); ++y) {
      float* row = values.row(channel, y);
      const auto first = static_cast<std::uint64_t>(channel * values.rows() + y) * values.columns();
      for (int x = 0; x < values.columns(); ++x) {
        row[x] = unit_random(seed, first + x) < share ? 0.0F : kept_scale(share) * row[x];
      }
      values.fill_border(channel, y);
    }
  }
}

void scale(float factor, Tensor& values) {
  if (factor == 1.0F) return;
  for (int channel = 0; channel < values.channels(); ++channel) {
    for (int y = 0; y < values.rows(); ++y) {
      float* row = values.row(channel, y);
      for (int x = 0; x < values.columns(); ++x) row[x] *= factor;
      values.fill_border(channel, y);
    }
  }
}

}  // namespace

ConvolutionGraph::ConvolutionGraph(std::vector<ConvolutionStep> steps,
                                   const std::vector<int>& channels, int rows, int columns,
                                   InstructionSet instruction_set, int threads,
                                   ColumnPadding column_padding)
    : steps_(std::move(steps)), shapes_(channels.size()), row_biases_(steps_.size()) {
  shapes_[0] = Tensor(channels[0], rows, columns, column_padding);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const ConvolutionStep& step = steps_[i];
    const Tensor& from = shapes_[step.from];
    shapes_[step.to] = Tensor(channels[step.to], size_after(step, from.rows()),
                              size_after(step, from.columns()), column_padding);
    const Tensor& to = shapes_[step.to];
    const int padding = step.transposed ? 0 : step.kernel / 2;
    layers_.emplace_back(ConvolutionShape{.input_channels = from.channels(),
                                          .output_channels = to.channels(),
                                          .kernel_rows = step.kernel,
                                          .kernel_columns = step.kernel,
                                          .stride = step.stride,
                                          .padding_rows = padding,
                                          .padding_columns = padding,
                                          .transposed = step.transposed},
                         from, to, instruction_set, threads);
    if (step.row_bias) row_biases_[i] = to;
  }
}

std::vector<ParameterShape> ConvolutionGraph::parameter_shapes() const {
  std::vector<ParameterShape> shapes;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const ConvolutionStep& step = steps_[i];
    const int in = layers_[i].shape().input_channels;
    const int out = layers_[i].shape().output_channels;
    const int first = step.transposed ? in : out;
    add_convolution(step.name, {first, step.transposed ? out : in, step.kernel, step.kernel},
                    step.bias ? out : 0, shapes);
    if (step.row_bias) {
      shapes.push_back({step.name + ".row_bias", {out, shapes_[step.to].rows()}});
    }
  }
  return shapes;
}

std::vector<float> ConvolutionGraph::initial_parameters(std::uint64_t seed) const {
  UniformStart start(seed);
  std::vector<float> parameters;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const ConvolutionStep& step = steps_[i];
    // PyTorch counts the fan-in of both kinds of convolution in the second extent.
    const int second =
        step.transposed ? layers_[i].shape().output_channels : layers_[i].shape().input_channels;
    const auto fan_in = static_cast<float>(second * step.kernel * step.kernel);
    start.add(layers_[i].shape().weights(), step.start_scale / std::sqrt(fan_in), parameters);
    if (step.bias)
      start.add(layers_[i].shape().output_channels, 0.1F * step.start_scale, parameters);
    if (step.row_bias) {
      const std::size_t rows = shapes_[step.to].rows();
      parameters.insert(parameters.end(), rows * layers_[i].shape().output_channels, 0.0F);
    }
  }
  return parameters;
}

std::int64_t ConvolutionGraph::multiply_adds() const {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < steps_.size(); ++i) sum += multiply_adds(i);
  return sum;
}

std::int64_t ConvolutionGraph::multiply_adds(std::size_t i) const {
  const Tensor& pixels = shapes_[steps_[i].transposed ? steps_[i].from : steps_[i].to];
  return layers_[i].shape().weights() * pixels.rows() * pixels.columns();
}

void ConvolutionGraph::set_parameters(std::span<const float> parameters) {
  check_parameters(parameters, parameter_shapes());
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const std::span<const float> weight = take(parameters, layers_[i].shape().weights());
    const std::span<const float> bias =
        take(parameters, steps_[i].bias ? layers_[i].shape().output_channels : 0);
    layers_[i].set_parameters(weight, bias);
    if (!steps_[i].row_bias) continue;
    Tensor& rows = row_biases_[i];
    for (int channel = 0; channel < rows.channels(); ++channel) {
      const std::span<const float> values = take(parameters, rows.rows());
      for (int row = 0; row < rows.rows(); ++row) {
        std::fill_n(rows.row(channel, row), rows.columns(), values[row]);
      }
    }
  }
}

LayerEnd ConvolutionGraph::end_of(std::size_t i, const std::vector<Tensor>& values) const {
  const ConvolutionStep& step = steps_[i];
  const Tensor* skip = step.skip ? &values[*step.skip] : nullptr;
  return {step.negative_slope, step.row_bias ? &row_biases_[i] : skip};
}

void ConvolutionGraph::forward(std::vector<Tensor>& values, int left_out,
                               std::optional<std::uint64_t> dropout_seed) {
  for (std::size_t i = 0; i + left_out < steps_.size(); ++i) {
    const ConvolutionStep& step = steps_[i];
    layers_[i].forward(values[step.from], end_of(i, values), values[step.to]);
    if (dropout_seed) drop_out(*dropout_seed + i, step.dropout, values[step.to]);
  }
}

std::vector<NetworkStep> ConvolutionGraph::steps(std::vector<Tensor>& values) {
  std::vector<NetworkStep> steps;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    Conv2d& layer = layers_[i];
    const Tensor& input = values[steps_[i].from];
    Tensor& output = values[steps_[i].to];
    steps.push_back({.name = steps_[i].name,
                     .multiply_adds = multiply_adds(i),
                     .run = [&layer, &input, end = end_of(i, values), &output] {
                       layer.forward(input, end, output);
                     }});
    if (steps_[i].transposed) continue;
    const std::vector<float> weight(static_cast<std::size_t>(layer.shape().weights()), 0.5F);
    steps.back().reference = [&layer, weight, &input, rows = output.rows(),
                              columns = output.columns()] {
      Tensor result(layer.shape().output_channels, rows, columns, input.padding());
      conv2d_reference(layer.shape(), weight, {}, input, result);
    };
  }
  return steps;
}

void ConvolutionGraph::last_step_row(const std::vector<Tensor>& values, int row, float* output,
                                     std::int64_t channel_stride) const {
  layers_.back().forward_row(values[steps_.back().from], row, output, channel_stride);
}

std::optional<int> ConvolutionGraph::used_as_skip_for(int index) const {
  for (const ConvolutionStep& step : steps_) {
    if (step.skip == index) return step.to;
  }
  return std::nullopt;
}

const ConvolutionStep* ConvolutionGraph::step_before(int index) const {
  for (const ConvolutionStep& step : steps_) {
    if (step.to == index) return &step;
  }
  return nullptr;
}

LayerEnd ConvolutionGraph::input_gradient_end(const ConvolutionStep& step,
                                              const std::vector<Tensor>& values,
                                              const std::vector<Tensor>& gradients) const {
  LayerEnd end;
  if (const std::optional<int> skip = used_as_skip_for(step.from)) end.skip = &gradients[*skip];
  const ConvolutionStep* const before = step_before(step.from);
  if (before != nullptr && before->negative_slope != 1.0F) {
    end.activated = &values[step.from];
    end.negative_slope = before->negative_slope;
  }
  return end;
}

void ConvolutionGraph::last_step_backward_rows(const std::vector<Tensor>& values, int first_row,
                                               const Tensor& d_output,
                                               std::vector<Tensor>& gradients,
                                               std::span<float> d_parameters) {
  const ConvolutionStep& step = steps_.back();
  const ConvolutionShape& convolution = layers_.back().shape();
  const std::size_t biases = step.bias ? convolution.output_channels : 0;
  const std::span<float> d_bias = d_parameters.last(biases);
  const std::span<float> d_weight =
      d_parameters.first(d_parameters.size() - biases).last(convolution.weights());
  layers_.back().backward_rows(values[step.from], first_row, d_output,
                               input_gradient_end(step, values, gradients), gradients[step.from],
                               d_weight, d_bias);
}

void ConvolutionGraph::backward(const std::vector<Tensor>& values, std::vector<Tensor>& gradients,
                                std::span<float> d_parameters, bool dropped, int left_out) {
  const std::size_t steps = steps_.size() - left_out;
  std::vector<std::span<float>> d_arrays;
  for (const ParameterShape& array : parameter_shapes()) {
    d_arrays.push_back(take(d_parameters, array.elements()));
  }
  for (std::size_t i = steps; i < steps_.size(); ++i) {
    d_arrays.resize(d_arrays.size() - 1 - steps_[i].bias - steps_[i].row_bias);
  }
  if (left_out == 0 && steps_.back().negative_slope != 1.0F) {
    leaky_relu_backward(steps_.back().negative_slope, values.back(), gradients.back());
  }
  for (std::size_t i = steps; i-- > 0;) {
    const ConvolutionStep& step = steps_[i];
    const Tensor& d_to = gradients[step.to];
    if (step.row_bias) {
      const std::span<float> d_rows = d_arrays.back();
      d_arrays.pop_back();
      for (int channel = 0; channel < d_to.channels(); ++channel) {
        for (int row = 0; row < d_to.rows(); ++row) {
          const float* from = d_to.row(channel, row);
          float sum = 0.0F;
          for (int x = 0; x < d_to.columns(); ++x) sum += from[x];
          d_rows[static_cast<std::size_t>(channel) * d_to.rows() + row] += sum;
        }
      }
    }
    std::span<float> d_bias;
    if (step.bias) {
      d_bias = d_arrays.back();
      d_arrays.pop_back();
    }
    const std::span<float> d_weight = d_arrays.back();
    d_arrays.pop_back();
    layers_[i].backward_parameters(values[step.from], d_to, d_weight, d_bias);
    layers_[i].backward_input(d_to, input_gradient_end(step, values, gradients),
                              gradients[step.from]);
    const ConvolutionStep* const before = step_before(step.from);
    if (dropped && before != nullptr) scale(kept_scale(before->dropout), gradients[step.from]);
  }
}

}  // namespace hqslam::nn
