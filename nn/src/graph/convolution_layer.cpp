#include "convolution_layer.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "../activation.h"
#include "../conv2d.h"
#include "tensor_sums.h"

namespace hqslam::nn {
namespace {

ConvolutionShape shape_of(const ConvolutionOptions& o, const TensorShape& input) {
  return {input.channels, o.channels,        o.kernel_rows,    o.kernel_columns, o.stride_rows,
          o.padding_rows, o.padding_columns, o.stride_columns, o.transposed};
}

TensorShape output_of(const ConvolutionOptions& o, const TensorShape& input) {
  if (o.transposed) {
    return {o.channels, input.rows * o.stride_rows, input.columns * o.stride_columns,
            input.padding};
  }
  const int columns =
      input.padding == ColumnPadding::kCircular
          ? input.columns / o.stride_columns
          : convolved_size(input.columns, o.kernel_columns, o.stride_columns, o.padding_columns);
  return {o.channels, convolved_size(input.rows, o.kernel_rows, o.stride_rows, o.padding_rows),
          columns, input.padding};
}

class Convolution final : public Layer {
 public:
  Convolution(const ConvolutionOptions& options, const TensorShape& input, const Engine& engine)
      : Layer(output_of(options, input)),
        options_(options),
        shape_(shape_of(options, input)),
        input_(input),
        computed_pixels_((options.transposed ? input.rows : output_.rows) *
                         (options.transposed ? input.columns : output_.columns)),
        layer_(shape_, input.make(), output_.make(), engine.instruction_set, engine.threads) {}

  std::int64_t multiply_adds() const override { return shape_.weights() * computed_pixels_; }

  std::vector<ParameterShape> parameter_shapes() const override {
    int first = shape_.output_channels;
    int second = shape_.input_channels;
    if (options_.transposed) std::swap(first, second);
    std::vector<ParameterShape> shapes{
        {"weight", {first, second, shape_.kernel_rows, shape_.kernel_columns}}};
    if (options_.linear) shapes.front().shape.resize(2);
    if (options_.bias) shapes.push_back({"bias", {shape_.output_channels}});
    return shapes;
  }

  void add_initial_parameters(UniformStart& start, std::vector<float>& parameters) const override {
    start.add(shape_.weights(), std::numbers::sqrt3_v<float> * options_.start_deviation,
              parameters);
    if (options_.bias)
      parameters.insert(parameters.end(), shape_.output_channels, options_.start_bias);
  }

  void set_parameters(std::span<const float> parameters) override {
    const std::span<const float> weight = take(parameters, shape_.weights());
    layer_.set_parameters(weight, parameters);
  }

  void forward(const LayerPass& pass) override {
    const Tensor* skip = pass.inputs.size() > 1 ? pass.inputs[1] : nullptr;
    layer_.forward(*pass.inputs[0], {options_.negative_slope, skip}, *pass.output);
  }

  void backward(std::span<const LayerPass> batch, std::span<float> d_parameters) override {
    const std::span<float> d_weight = take(d_parameters, shape_.weights());
    for (const LayerPass& pass : batch) {
      const Tensor* d_sum = pass.d_output;
      if (options_.negative_slope != 1.0F) {
        d_sum_ = *pass.d_output;
        leaky_relu_backward(options_.negative_slope, *pass.output, d_sum_);
        d_sum = &d_sum_;
      }
      if (d_input_.channels() == 0) d_input_ = input_.make();
      layer_.backward_parameters(*pass.inputs[0], *d_sum, d_weight, d_parameters);
      layer_.backward_input(*d_sum, {}, d_input_);
      add_channels(d_input_, d_input_.channels(), *pass.d_inputs[0]);
      if (pass.inputs.size() > 1) {
        add_channels(*d_sum, d_sum->channels(), *pass.d_inputs[1]);
      }
    }
  }

 private:
  ConvolutionOptions options_;
  ConvolutionShape shape_;
  TensorShape input_;
  std::int64_t computed_pixels_;  ///< of the side with fewer
  Conv2d layer_;
  Tensor d_sum_;
  Tensor d_input_;
};

}  // namespace

std::unique_ptr<Layer> make_convolution(const ConvolutionOptions& options, const TensorShape& input,
                                        const Engine& engine) {
  return std::make_unique<Convolution>(options, input, engine);
}

}  // namespace hqslam::nn
