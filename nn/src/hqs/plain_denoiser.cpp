#include "plain_denoiser.h"

#include <fmt/format.h>

#include <cmath>

#include "../convolution_step.h"
#include "../layers/dropout.h"
#include "../parameters.h"
#include "hqslam/core/error.h"

namespace hqslam::nn {
namespace {

class PlainDenoiser final : public Denoiser {
 public:
  PlainDenoiser(const PlainDenoiserShape& shape, int rows, int columns,
                InstructionSet instruction_set, int threads);

  TileSize tile() const override { return {}; }
  ColumnPadding padding() const override { return ColumnPadding::kZero; }
  int memory_channels() const override { return 0; }
  std::vector<ParameterShape> parameter_shapes() const override;
  std::vector<float> initial_parameters(std::uint64_t seed) const override;
  std::int64_t multiply_adds() const override;
  DenoiserState make_state(bool for_backward) const override;
  void set_parameters(std::span<const float> parameters) override;
  void forward(const Candidates& candidates, DenoiserState& state,
               std::optional<std::uint64_t> dropout_seed) override;
  void backward(const Candidates& candidates, const DenoiserState& state, DenoiserState& gradient,
                std::span<float> d_parameters) override;
  std::vector<NetworkStep> steps(const Candidates& candidates, DenoiserState& state) override;

 private:
  void drop_out(std::uint64_t seed, Tensor& values) const;
  /// d_values: d loss / d (after ReLU and dropout) in, before them out. What was dropped is 0, as
  /// what ReLU cut off is.
  void backward_activation(const Tensor& values, bool dropped, Tensor& d_values) const;

  PlainDenoiserShape shape_;
  int rows_;
  int columns_;
  std::vector<Conv2d> layers_;
  bool dropped_out_ = false;
};

PlainDenoiser::PlainDenoiser(const PlainDenoiserShape& shape, int rows, int columns,
                             InstructionSet instruction_set, int threads)
    : shape_(shape), rows_(rows), columns_(columns) {
  const DenoiserState state = make_state(true);
  for (int i = 0; i < shape.convolutions; ++i) {
    const Tensor& from = state.values[i];
    const Tensor& to = i + 1 == shape.convolutions ? state.z : state.values[i + 1];
    layers_.emplace_back(ConvolutionShape{from.channels(), to.channels(), 3, 3, 1, 1, 1}, from, to,
                         instruction_set, threads);
  }
}

std::vector<ParameterShape> PlainDenoiser::parameter_shapes() const {
  std::vector<ParameterShape> shapes;
  for (int i = 0; i < shape_.convolutions; ++i) {
    const int from = i == 0 ? 1 : shape_.features;
    const int to = i + 1 == shape_.convolutions ? 1 : shape_.features;
    add_convolution(fmt::format("convolution.{}", i), {to, from, 3, 3}, 0, shapes);
  }
  return shapes;
}

std::vector<float> PlainDenoiser::initial_parameters(std::uint64_t seed) const {
  UniformStart start(seed);
  std::vector<float> parameters;
  for (const ParameterShape& shape : parameter_shapes()) {
    const std::int64_t fan_in = shape.elements() / shape.shape[0];
    start.add(shape.elements(), 1.0F / std::sqrt(static_cast<float>(fan_in)), parameters);
  }
  return parameters;
}

std::int64_t PlainDenoiser::multiply_adds() const {
  return elements(parameter_shapes()) * rows_ * columns_;
}

DenoiserState PlainDenoiser::make_state(bool /*for_backward*/) const {
  DenoiserState state;
  state.values.emplace_back(1, rows_, columns_, padding());
  for (int i = 0; i + 1 < shape_.convolutions; ++i) {
    state.values.emplace_back(shape_.features, rows_, columns_, padding());
  }
  state.values.emplace_back(1, 1, 1, padding());  // no memory
  state.z = Tensor(1, rows_, columns_, padding());
  return state;
}

void PlainDenoiser::set_parameters(std::span<const float> parameters) {
  check_parameters(parameters, parameter_shapes());
  for (Conv2d& layer : layers_) {
    layer.set_parameters(take(parameters, layer.shape().weights()), {});
  }
}

void PlainDenoiser::drop_out(std::uint64_t seed, Tensor& values) const {
  const float scale = 1.0F / (1.0F - shape_.dropout);
#pragma omp for schedule(static)
  for (int channel = 0; channel < values.channels(); ++channel) {
    for (int y = 0; y < values.rows(); ++y) {
      float* row = values.row(channel, y);
      const auto first = static_cast<std::uint64_t>(channel * values.rows() + y) * columns_;
      for (int x = 0; x < columns_; ++x) {
        row[x] = unit_random(seed, first + x) < shape_.dropout ? 0.0F : scale * row[x];
      }
      values.fill_border(channel, y);
    }
  }
}

void PlainDenoiser::forward(const Candidates& /*candidates*/, DenoiserState& state,
                            std::optional<std::uint64_t> dropout_seed) {
  const int last = shape_.convolutions - 1;
  for (int i = 0; i < last; ++i) {
    layers_[i].forward(state.values[i], {0.0F}, state.values[i + 1]);
    if (dropout_seed) drop_out(*dropout_seed + i, state.values[i + 1]);
  }
  layers_[last].forward(state.values[last], {}, state.z);
#pragma omp master
  dropped_out_ = dropout_seed.has_value();
}

std::vector<NetworkStep> PlainDenoiser::steps(const Candidates& /*candidates*/,
                                              DenoiserState& state) {
  std::vector<NetworkStep> steps;
  for (int i = 0; i < shape_.convolutions; ++i) {
    const bool last = i + 1 == shape_.convolutions;
    steps.push_back(convolution_step(fmt::format("convolution.{}", i), layers_[i], state.values[i],
                                     {last ? 1.0F : 0.0F}, last ? state.z : state.values[i + 1]));
  }
  return steps;
}

void PlainDenoiser::backward_activation(const Tensor& values, bool dropped,
                                        Tensor& d_values) const {
  const float scale = dropped ? 1.0F / (1.0F - shape_.dropout) : 1.0F;
  for (int channel = 0; channel < values.channels(); ++channel) {
    for (int y = 0; y < values.rows(); ++y) {
      const float* value = values.row(channel, y);
      float* gradient = d_values.row(channel, y);
      for (int x = 0; x < columns_; ++x) gradient[x] *= value[x] > 0.0F ? scale : 0.0F;
      d_values.fill_border(channel, y);
    }
  }
}

void PlainDenoiser::backward(const Candidates& /*candidates*/, const DenoiserState& state,
                             DenoiserState& gradient, std::span<float> d_parameters) {
  std::vector<std::span<float>> d_weights;
  for (const Conv2d& layer : layers_)
    d_weights.push_back(take(d_parameters, layer.shape().weights()));
  gradient.z.fill_borders();
  for (int i = shape_.convolutions - 1; i >= 0; --i) {
    const Tensor& input = state.values[i];
    const Tensor& d_output = i + 1 == shape_.convolutions ? gradient.z : gradient.values[i + 1];
    Tensor& d_input = gradient.values[i];
    layers_[i].backward_parameters(input, d_output, d_weights[i], {});
    layers_[i].backward_input(d_output, {}, d_input);
    if (i > 0) backward_activation(input, dropped_out_, d_input);
  }
}

void validate(const PlainDenoiserShape& shape) {
  constexpr int kMostFeatures = 512;
  constexpr int kMostConvolutions = 20;
  check_field("features", shape.features, 1, kMostFeatures);
  check_field("convolutions", shape.convolutions, 2, kMostConvolutions);
  if (!(shape.dropout >= 0.0F && shape.dropout < 1.0F)) {
    throw Error(fmt::format("denoiser: dropout is {}, expected 0 to below 1", shape.dropout));
  }
}

}  // namespace

DenoiserDescription plain_denoiser(const PlainDenoiserShape& shape) {
  validate(shape);
  return {"plain",
          {{"features", shape.features},
           {"convolutions", shape.convolutions},
           {"dropout", shape.dropout}},
          {1, 1},
          [shape](int rows, int columns, InstructionSet instruction_set, int threads) {
            return std::make_unique<PlainDenoiser>(shape, rows, columns, instruction_set, threads);
          }};
}

DenoiserDescription read_plain_denoiser(JsonFields& sizes) {
  PlainDenoiserShape shape;
  sizes.optional("features", shape.features);
  sizes.optional("convolutions", shape.convolutions);
  sizes.optional("dropout", shape.dropout);
  return plain_denoiser(shape);
}

}  // namespace hqslam::nn
